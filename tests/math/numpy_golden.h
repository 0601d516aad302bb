// Printed by tests/math/print_numpy_golden.py with numpy 2.4.6.
#pragma once

#include <array>
#include <cstdint>

namespace manyhands {

struct NumpyGolden {
  std::uint64_t seed;
  std::array<std::uint64_t, 2> state, increment;
  // Drawn in this order.
  double random;
  std::array<double, 3> goal;  // uniform in [-0.15, 0.15] x [-0.15, 0.15] x [0, 0.3]
  std::array<double, 4> normals;
  std::uint64_t bits_of_many;  // exclusive or of the bits of the next 200000 normals
  double largest_of_many;
  std::array<std::uint64_t, 2> end;  // the state after them
};

inline constexpr int kManyNormals = 200000;
inline constexpr NumpyGolden kNumpyGolden[] = {
    {0x0u,
     {0x9585eb7a69561e3u, 0x1aa1b5345996452du},
     {0x588133bc447873a9u, 0x418ddadb3af71a82u},
     0x1.461fd79fb3850p-1,
     {-0x1.1ae2d68a58b75p-4, -0x1.1a069f367611dp-3, 0x1.44f25038fa7b3p-8},
     {-0x1.1243418e643edp-1, 0x1.7245f95ced1e6p-2, 0x1.4dd2f26bd103cp+0, 0x1.e4e7cbc69bca3p-1},
     0xf800d4076eb34bu,
     0x1.2ed8650fafb3cp+2,
     {0xea505b696e2baea3u, 0x6b9cb5ee11dc5c41u}},
    {0x1u,
     {0x2a6e7d6f320fbc7eu, 0x9c5b484bfedb756cu},
     {0xa19857b95740937bu, 0x922af2da2645f895u},
     0x1.060d7be6f245cp-1,
     {0x1.14c3d029032cdp-3, -0x1.b541b4fca1f92p-4, 0x1.236cd404fcceep-2},
     {0x1.cf8acddd349f3p-1, 0x1.c9166a7847147p-2, -0x1.12eb88d2b5275p-1, 0x1.29884fe946122p-1},
     0xfe07a4d3894ea999u,
     0x1.1a01b234764ebp+2,
     {0xd2cb9c6b1b348ca5u, 0x92b5f3e32687b3d6u}},
    {0x2au,
     {0xacbc7c9d68860ac8u, 0xcea44f6798798f2au},
     {0x66caf2e28d25abffu, 0xfa505436c9a8416eu},
     0x1.8c43f79a2db24p-1,
     {-0x1.2c6cb8ad08408p-6, 0x1.b8a526d87a7d2p-4, 0x1.ac7681bb68014p-3},
     {-0x1.f3770ac89d08fp+0, -0x1.4d5ba2db7ebc8p+0, 0x1.05d13075b0043p-3, -0x1.43d5191edf2d2p-2},
     0x80ef1b01aa4bcd02u,
     0x1.40768ac31b664p+2,
     {0x4aeebdd401846907u, 0x28c7759ee4b5caa4u}},
    {0xffffffffu,
     {0xc57a3ce19c86ba9au, 0x4c233832246aa48cu},
     {0xad12d969e7b701fbu, 0xda9580daf0fe872cu},
     0x1.01fd7ea4c363ep-2,
     {-0x1.59364252ec71dp-4, -0x1.056270eba2559p-4, 0x1.7c4d573ae97c6p-3},
     {-0x1.2a401b3786714p+0, 0x1.67d5491f6c0d8p-1, -0x1.9988d5da90a2dp-2, 0x1.ae042365fc953p-3},
     0xbd9b72a454bu,
     0x1.1903548ef1c2bp+2,
     {0xfc384048f01c94a9u, 0xf64150d1094528f1u}},
    {0x100000000u,
     {0x21bbf7fbff1ac5d4u, 0x24d060cf1520dbddu},
     {0x7b62eea7340ca9c7u, 0x77ff3ed86c5c5633u},
     0x1.c78bd7c50b582p-1,
     {0x1.18d84e4643bd0p-6, 0x1.71c17fdb0ddc6p-4, 0x1.25d74eb5130dep-2},
     {-0x1.261f7a4a1f871p-1, 0x1.f89bf6cd1f5a4p+0, 0x1.92cc1b93a551ap-2, -0x1.2eaaa2f5f6c00p-9},
     0x270cd6567746a8u,
     0x1.1a84a180e931ep+2,
     {0x4b355328253feef5u, 0xb84830ab0933de2bu}},
    {0x123456789abcdef0u,
     {0x376b9ca7fa4c33c6u, 0x9d84f0228dae1bb9u},
     {0xb7a96858e6c63bc9u, 0xe4e230777823c5e3u},
     0x1.a22a998dd373cp-3,
     {-0x1.36e83f6f6679ap-5, 0x1.9972c05cf6c00p-12, 0x1.b4cb41c894eb3p-3},
     {-0x1.27c9356f38bb8p-1, -0x1.1951983c6e30ep+0, -0x1.db1ed4d74e667p-3, 0x1.9da5f6229325dp-1},
     0x7e43c71ff6d5cdd0u,
     0x1.43061de640530p+2,
     {0x7555804099276ed2u, 0xa811a9a2bad267c2u}},
    {0xffffffffffffffffu,
     {0x4d8b0a3b048acdb0u, 0xddc419442aebde79u},
     {0x4ed623c7d18951edu, 0x37762aacb3cc854fu},
     0x1.5c2c74f5188eap-1,
     {0x1.a851afcfc2a6ep-4, -0x1.2ea6cbc323c61p-3, 0x1.12cfb33885290p-2},
     {-0x1.96bfdca5babc4p-6, -0x1.f0a8b8b15689ep-1, 0x1.0950f9bcd8210p+0, 0x1.9cb0635c35311p-1},
     0x7f7563b0bfe9335bu,
     0x1.31bd53e4f8436p+2,
     {0x6556ae5607a60cb7u, 0x8e31b1c69b9cc61u}},
};

}  // namespace manyhands
