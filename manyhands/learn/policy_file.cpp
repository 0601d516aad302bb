#include "manyhands/learn/policy_file.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <iterator>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "manyhands/learn/protobuf.h"

namespace manyhands::learn {

namespace {

using Bytes = std::span<const std::byte>;
using Field = ProtobufReader::Field;

/// A constant of the graph: (rows, columns), row-major; without dimensions (1, 1), with one (n, 1).
struct Array {
  std::size_t rows = 1, columns = 1;
  std::vector<float> values;
};

struct Node {
  std::string operation;
  std::vector<std::string> inputs, outputs;
};

/// What of an ONNX model a policy is told by (onnx.proto names the fields' numbers).
struct Graph {
  std::map<std::string, Array> constants;
  std::map<std::string, int> sizes;  // of the inputs' rows
  std::vector<Node> nodes;
  std::string env_id;
};

/// Calls visit(field) for every field of a message.
template <class Visit>
void for_each_field(Bytes message, Visit&& visit) {
  ProtobufReader reader(message);
  Field field;
  while (reader.next(field)) visit(field);
}

/// IEEE 754 binary16.
float from_half(std::uint16_t half) {
  const int exponent = half >> 10 & 31, fraction = half & 1023;
  float magnitude =
      std::ldexp(static_cast<float>(exponent == 0 ? fraction : fraction + 1024), std::max(exponent, 1) - 25);
  if (exponent == 31) magnitude = std::numeric_limits<float>::infinity();
  return half >> 15 != 0 ? -magnitude : magnitude;
}

template <class T>
std::vector<T> values_of(Bytes raw) {
  std::vector<T> values(raw.size() / sizeof(T));
  if (raw.size() != values.size() * sizeof(T)) throw std::invalid_argument("an array ends in the middle");
  if (!values.empty()) std::memcpy(values.data(), raw.data(), raw.size());
  return values;
}

void read_constant(Bytes message, Graph& graph) {
  constexpr std::uint64_t kFloat = 1, kFloat16 = 10;
  std::vector<std::uint64_t> dims;
  std::uint64_t type = 0;
  std::string name;
  Bytes raw;
  for_each_field(message, [&](const Field& field) {
    if (field.number == 1 && field.bytes.empty()) dims.push_back(field.value);
    for (ProtobufReader packed(field.number == 1 ? field.bytes : Bytes()); !packed.done();)
      dims.push_back(packed.varint());
    if (field.number == 2) type = field.value;
    if (field.number == 8) name = field.text();
    if (field.number == 9) raw = field.bytes;
  });
  Array array;
  if (type == kFloat) {
    array.values = values_of<float>(raw);
  } else if (type == kFloat16) {
    for (const std::uint16_t half : values_of<std::uint16_t>(raw)) array.values.push_back(from_half(half));
  } else {
    throw std::invalid_argument("its constant " + name + " is of no kind that policies have");
  }
  const std::size_t count = array.values.size();
  if (dims.size() > 2) throw std::invalid_argument("its constant " + name + " has more than two axes");
  for (const std::uint64_t dim : dims) {
    if (dim > count) throw std::invalid_argument("its constant " + name + " is of another shape");
  }
  if (!dims.empty()) array.rows = static_cast<std::size_t>(dims[0]);
  if (dims.size() > 1) array.columns = static_cast<std::size_t>(dims[1]);
  if (array.rows * array.columns != count) throw std::invalid_argument("its constant " + name + " is of another shape");
  graph.constants[name] = std::move(array);
}

/// The length of an input's rows: ValueInfoProto.type.tensor_type.shape, whose last dimension it is.
void read_input(Bytes message, Graph& graph) {
  std::string name;
  std::uint64_t size = 0;
  const auto descend = [](Bytes from, int number, auto&& inner) {
    for_each_field(from, [&](const Field& field) {
      if (field.number == number) inner(field.bytes);
    });
  };
  for_each_field(message, [&](const Field& field) {
    if (field.number == 1) name = field.text();
    if (field.number != 2) return;
    descend(field.bytes, 1, [&](Bytes tensor) {
      descend(tensor, 2, [&](Bytes shape) {
        descend(shape, 1, [&](Bytes dimension) {
          size = 0;
          for_each_field(dimension, [&](const Field& one) {
            if (one.number == 1) size = one.value;
          });
        });
      });
    });
  });
  if (size == 0 || size > 1'000'000) throw std::invalid_argument("its input " + name + " has no length");
  graph.sizes[name] = static_cast<int>(size);
}

/// A constant of 16 bits is cast to 32 where it is used: it goes by both names here.
void read_node(Bytes message, Graph& graph) {
  Node node;
  for_each_field(message, [&](const Field& field) {
    if (field.number == 1) node.inputs.push_back(field.text());
    if (field.number == 2) node.outputs.push_back(field.text());
    if (field.number == 4) node.operation = field.text();
  });
  if (node.outputs.size() != 1) throw std::invalid_argument("its operation " + node.operation + " has several results");
  const bool of_constant = node.operation == "Cast" && !node.inputs.empty() && graph.constants.contains(node.inputs[0]);
  if (of_constant) {
    graph.constants[node.outputs[0]] = graph.constants.at(node.inputs[0]);
  } else {
    graph.nodes.push_back(std::move(node));
  }
}

Graph read_graph(Bytes model) {
  Graph graph;
  Bytes inner;
  for_each_field(model, [&](const Field& field) {
    if (field.number == 7) inner = field.bytes;
    if (field.number != 14) return;
    std::string key, value;
    for_each_field(field.bytes, [&](const Field& entry) { (entry.number == 1 ? key : value) = entry.text(); });
    if (key == "env_id") graph.env_id = value;
  });
  for_each_field(inner, [&](const Field& field) {
    if (field.number == 5) read_constant(field.bytes, graph);
    if (field.number == 11) read_input(field.bytes, graph);
  });
  for_each_field(inner, [&](const Field& field) {
    if (field.number == 1) read_node(field.bytes, graph);
  });
  return graph;
}

/// Takes a graph's operations in the order in which our files have them.
class Operations {
 public:
  explicit Operations(const Graph& graph) : graph_(graph) {}

  /// The next operation if it is this one, else null.
  const Node* take_if(const char* operation) {
    if (done() || graph_.nodes[next_].operation != operation) return nullptr;
    return &graph_.nodes[next_++];
  }

  const Node& take(const char* operation) {
    const Node* node = take_if(operation);
    if (node == nullptr) fail();
    return *node;
  }

  [[nodiscard]] const Array& constant(const Node& node, std::size_t input) const {
    if (input >= node.inputs.size() || !graph_.constants.contains(node.inputs[input])) fail();
    return graph_.constants.at(node.inputs[input]);
  }

  /// Whether the next operation gives this value.
  [[nodiscard]] bool begins(const char* value) const { return !done() && graph_.nodes[next_].outputs.front() == value; }

  [[nodiscard]] bool done() const { return next_ == graph_.nodes.size(); }

  [[noreturn]] void fail() const {
    std::string names;
    for (const Node& node : graph_.nodes) names += (names.empty() ? "" : ", ") + node.operation;
    throw std::invalid_argument("it is no policy that a trainer of ours made: its operations are " + names);
  }

 private:
  const Graph& graph_;
  std::size_t next_ = 0;
};

/// Pairs (i, k) from the matrix (observation_dim, 3 pairs) that takes the differences of an observation.
std::vector<int> differences_of(const Array& matrix) {
  std::vector<int> pairs;
  for (std::size_t column = 0; column + 3 <= matrix.columns; column += 3) {
    int plus = -1, minus = -1;
    for (std::size_t row = 0; row < matrix.rows; ++row) {
      const float entry = matrix.values[row * matrix.columns + column];
      if (entry > 0) plus = static_cast<int>(row);
      if (entry < 0) minus = static_cast<int>(row);
    }
    pairs.insert(pairs.end(), {plus, minus});
  }
  return pairs;
}

/// Where the quaternion is, from the matrix that takes it; what is made of it is always the same.
int take_cube_rotation(Operations& operations) {
  const Array& matrix = operations.constant(operations.take("MatMul"), 1);
  std::size_t row = 0;
  while (row < matrix.rows && matrix.values[row * matrix.columns] == 0) ++row;
  while (!operations.begins("cube_moments")) {
    if (operations.take_if("Mul") == nullptr && operations.take_if("Add") == nullptr) operations.take("MatMul");
  }
  operations.take("MatMul");
  return static_cast<int>(row);
}

Policy::Layer layer_of(const Array& weight, const Array& bias) {
  return {.inputs = static_cast<int>(weight.columns),
          .outputs = static_cast<int>(weight.rows),
          .weight = weight.values,
          .bias = bias.values};
}

/// After a layer: another one, or what becomes of the last one's output.
std::optional<PolicyOutput> take_activation(Operations& operations, HiddenActivation& activation) {
  if (operations.take_if("Relu") != nullptr) return {};
  if (operations.take_if("Tanh") != nullptr) {
    if (operations.done()) return PolicyOutput::kTanh;
    activation = HiddenActivation::kTanh;
    return {};
  }
  if (operations.take_if("Clip") != nullptr) return PolicyOutput::kClip;
  operations.take("ArgMax");
  operations.take("Cast");
  return PolicyOutput::kIndex;
}

Policy policy_of(const Graph& graph) {
  Operations operations(graph);
  const auto size = [&](const char* input) { return graph.sizes.contains(input) ? graph.sizes.at(input) : 0; };
  Policy policy;
  policy.env_id = graph.env_id;
  policy.observation_dim = size("observation");
  policy.goal_dim = size("desired_goal");
  if (operations.begins("cube_quaternion")) policy.relations.cube_rotation = take_cube_rotation(operations);
  if (policy.goal_dim > 0) operations.take("Sub");
  if (const Node* node = operations.take_if("MatMul")) {
    policy.relations.differences = differences_of(operations.constant(*node, 1));
  }
  operations.take("Concat");
  policy.mean = operations.constant(operations.take("Sub"), 1).values;
  policy.scale = operations.constant(operations.take("Mul"), 1).values;
  const Array& clip = operations.constant(operations.take("Clip"), 2);
  policy.clip = clip.values.empty() ? 0.0f : clip.values.front();
  std::optional<PolicyOutput> output;
  while (!output) {
    const Node& layer = operations.take("Gemm");
    policy.layers.push_back(layer_of(operations.constant(layer, 1), operations.constant(layer, 2)));
    output = take_activation(operations, policy.activation);
  }
  if (!operations.done()) operations.fail();
  policy.output = *output;
  policy.action_dim = policy.output == PolicyOutput::kIndex ? 1 : policy.layers.back().outputs;
  return policy;
}

}  // namespace

Policy read_policy(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file || std::filesystem::is_directory(path)) throw std::invalid_argument("there is no file " + path.string());
  const std::string bytes((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  try {
    Policy policy = policy_of(read_graph(std::as_bytes(std::span(bytes))));
    policy.validate();
    return policy;
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument(path.string() + " cannot be read as a policy: " + error.what());
  }
}

}  // namespace manyhands::learn
