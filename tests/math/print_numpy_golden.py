"""Prints tests/math/numpy_golden.h from the installed numpy.

`python tests/math/print_numpy_golden.py > tests/math/numpy_golden.h`
"""

import numpy as np

SEEDS = (0, 1, 42, 2**32 - 1, 2**32, 0x123456789ABCDEF0, 2**64 - 1)
MANY = 200_000  # enough normals to reach every layer of the ziggurat and its tail


def words(value: int) -> str:
    return f"{{{value & (2**64 - 1):#x}u, {value >> 64:#x}u}}"


def row(seed: int) -> str:
    rng = np.random.Generator(np.random.PCG64(np.random.SeedSequence(seed)))
    state = rng.bit_generator.state["state"]
    fields = [f"{seed:#x}u", words(state["state"]), words(state["inc"])]
    fields += [float(rng.random()).hex()]
    fields += ["{" + ", ".join(float(x).hex() for x in rng.uniform([-0.15, -0.15, 0], [0.15, 0.15, 0.3])) + "}"]
    fields += ["{" + ", ".join(float(x).hex() for x in rng.standard_normal(4)) + "}"]
    normals = rng.standard_normal(MANY)
    fields += [f"{np.bitwise_xor.reduce(normals.view(np.uint64)):#x}u", float(np.abs(normals).max()).hex()]
    fields += [words(rng.bit_generator.state["state"]["state"])]
    return "    {" + ",\n     ".join(fields) + "},"


def main() -> None:
    print(f"// Printed by tests/math/print_numpy_golden.py with numpy {np.__version__}.")
    print("#pragma once\n\n#include <array>\n#include <cstdint>\n\nnamespace manyhands {\n")
    print("struct NumpyGolden {")
    print("  std::uint64_t seed;")
    print("  std::array<std::uint64_t, 2> state, increment;")
    print("  // Drawn in this order.")
    print("  double random;")
    print("  std::array<double, 3> goal;  // uniform in [-0.15, 0.15] x [-0.15, 0.15] x [0, 0.3]")
    print("  std::array<double, 4> normals;")
    print(f"  std::uint64_t bits_of_many;  // exclusive or of the bits of the next {MANY} normals")
    print("  double largest_of_many;")
    print("  std::array<std::uint64_t, 2> end;  // the state after them")
    print("};\n")
    print(f"inline constexpr int kManyNormals = {MANY};")
    print("inline constexpr NumpyGolden kNumpyGolden[] = {")
    print("\n".join(row(seed) for seed in SEEDS))
    print("};\n\n}  // namespace manyhands")


if __name__ == "__main__":
    main()
