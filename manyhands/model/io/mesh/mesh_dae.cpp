// COLLADA 1.4 and 1.5: the triangles of the scene, placed by the transforms of its nodes. Only geometry is read; skins,
// materials and animations are not. Written here because general importers crash on damaged files.
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include "manyhands/math/quaternion.h"
#include "manyhands/model/io/mesh/mesh_file.h"
#include "manyhands/model/io/text_numbers.h"
#include "manyhands/model/io/xml_file.h"

namespace manyhands::io {

namespace {

/// Nodes and geometries may be used many times over, nodes within nodes: small files can describe huge scenes.
constexpr std::size_t kMostWork = 100'000'000;  ///< numbers read and elements visited
constexpr int kDeepestInstance = 64;
constexpr std::size_t kWorkOfNode = 100;
constexpr std::size_t kMostVertices = 20'000'000;

/// Any affine map; its matrix need not be a rotation.
using Affine = Transform<double>;

std::vector<double> read_numbers(const pugi::xml_node& node) {
  std::vector<double> numbers;
  for (const std::string_view word : split_blanks(node.child_value())) {
    const std::optional<double> number = parse_number(word);
    if (!number) {
      throw MeshError("<" + std::string(node.name()) + "> holds " + in_quotes(word) + "; expected numbers");
    }
    numbers.push_back(*number);
  }
  return numbers;
}

/// The map of one transform element of a node; the identity if it is no such element.
Affine read_transform(const pugi::xml_node& element) {
  const std::string_view tag = element.name();
  const std::size_t size = tag == "translate" || tag == "scale" ? 3 : tag == "rotate" ? 4 : tag == "matrix" ? 16 : 0;
  if (size == 0) return Affine::identity();
  const std::vector<double> v = read_numbers(element);
  if (v.size() != size) {
    throw MeshError("<" + std::string(tag) + "> has " + std::to_string(v.size()) + " numbers; expected " +
                    std::to_string(size));
  }
  if (tag == "translate") return {Mat3<double>::identity(), {v[0], v[1], v[2]}};
  if (tag == "scale") return {{{v[0], 0, 0}, {0, v[1], 0}, {0, 0, v[2]}}, Vec3<double>::zero()};
  if (tag == "matrix") {
    return {{{v[0], v[4], v[8]}, {v[1], v[5], v[9]}, {v[2], v[6], v[10]}}, {v[3], v[7], v[11]}};
  }
  const Vec3<double> axis{v[0], v[1], v[2]};
  const double length = norm(axis);
  if (!(length > 0)) return Affine::identity();
  const double angle = v[3] * std::numbers::pi / 180;
  return {to_matrix(quat_from_rotation_vector((angle / length) * axis)), Vec3<double>::zero()};
}

/// The map from the file's axes and unit to metres with z up.
Affine root_transform(const pugi::xml_node& asset) {
  const std::string_view unit = asset.child("unit").attribute("meter").value();
  const std::optional<double> meter = unit.empty() ? std::optional(1.0) : parse_number(unit);
  if (!meter || !(*meter > 0)) throw MeshError("the unit is " + in_quotes(unit) + " metres; expected a number above 0");
  const double m = *meter;
  const std::string_view up = asset.child_value("up_axis");
  if (up == "X_UP") return {{{0, 0, m}, {-m, 0, 0}, {0, -m, 0}}, Vec3<double>::zero()};
  if (up == "Z_UP") return {{{m, 0, 0}, {0, m, 0}, {0, 0, m}}, Vec3<double>::zero()};
  if (!up.empty() && up != "Y_UP") {
    throw MeshError("the up axis is " + in_quotes(up) + "; expected X_UP, Y_UP or Z_UP");
  }
  return {{{m, 0, 0}, {0, 0, m}, {0, -m, 0}}, Vec3<double>::zero()};
}

double determinant(const Mat3<double>& m) { return dot(m.x, cross(m.y, m.z)); }

class DaeReader {
 public:
  explicit DaeReader(const pugi::xml_node& root) : root_(root) { find_ids(); }

  Mesh read() {
    const Affine X_root = root_transform(root_.child("asset"));
    std::vector<Visit> stack;
    const pugi::xml_node instance = root_.child("scene").child("instance_visual_scene");
    const pugi::xml_node scene =
        instance ? target(instance, "url") : root_.child("library_visual_scenes").child("visual_scene");
    push_nodes(stack, scene, X_root, 0);
    while (!stack.empty()) {
      const Visit visit = stack.back();
      stack.pop_back();
      read_node(stack, visit);
    }
    return std::move(mesh_);
  }

 private:
  struct Visit {
    pugi::xml_node node;
    Affine X_parent;
    int depth;  ///< of nodes within nodes, instances included
  };

  void find_ids() {
    for (pugi::xml_node node = root_; node;) {
      if (const pugi::xml_attribute id = node.attribute("id")) ids_.emplace(id.value(), node);
      if (node.first_child()) {
        node = node.first_child();
        continue;
      }
      while (node != root_ && !node.next_sibling()) node = node.parent();
      node = node == root_ ? pugi::xml_node() : node.next_sibling();
    }
  }

  /// The element that `attribute` refers to as "#id"; only this file is searched.
  [[nodiscard]] pugi::xml_node target(const pugi::xml_node& from, const char* attribute) const {
    const std::string_view reference = from.attribute(attribute).value();
    const auto found = reference.starts_with('#') ? ids_.find(reference.substr(1)) : ids_.end();
    if (found == ids_.end()) {
      throw MeshError("<" + std::string(from.name()) + "> refers to " + in_quotes(reference) +
                      ", which is not in the file");
    }
    return found->second;
  }

  void spend(std::size_t work) {
    work_ += work;
    if (work_ > kMostWork) throw MeshError("the file describes too large a scene");
  }

  std::vector<double> numbers_of(const pugi::xml_node& node) {
    std::vector<double> numbers = read_numbers(node);
    spend(numbers.size() + 1);
    return numbers;
  }

  void push_nodes(std::vector<Visit>& stack, const pugi::xml_node& parent, const Affine& X, int depth) {
    for (const pugi::xml_node& child : parent.children("node")) {
      spend(kWorkOfNode);
      stack.push_back({child, X, depth});
    }
  }

  void read_node(std::vector<Visit>& stack, const Visit& visit) {
    if (visit.depth > kDeepestInstance) {
      throw MeshError("nodes are nested more than " + std::to_string(kDeepestInstance) + " deep");
    }
    Affine X = visit.X_parent;
    for (const pugi::xml_node& child : visit.node.children()) {
      spend(kWorkOfNode);
      X = X * read_transform(child);
    }
    for (const pugi::xml_node& child : visit.node.children("instance_geometry"))
      append(geometry(target(child, "url")), X);
    for (const pugi::xml_node& child : visit.node.children("instance_node")) {
      stack.push_back({target(child, "url"), X, visit.depth + 1});
    }
    push_nodes(stack, visit.node, X, visit.depth + 1);
  }

  void append(const std::vector<Vec3<double>>& positions, const std::vector<std::array<int, 3>>& triangles,
              const Affine& X) {
    const int first = static_cast<int>(mesh_.vertices.size());
    if (mesh_.vertices.size() + positions.size() > kMostVertices ||
        mesh_.triangles.size() + triangles.size() > kMostVertices) {
      throw MeshError("the scene has more than " + std::to_string(kMostVertices) + " vertices or triangles");
    }
    for (const Vec3<double>& p : positions) {
      const Vec3<double> q = X * p;
      mesh_.vertices.push_back({static_cast<float>(q.x), static_cast<float>(q.y), static_cast<float>(q.z)});
    }
    const bool mirrored = determinant(X.R) < 0;
    for (const auto& [a, b, c] : triangles) {
      mesh_.triangles.push_back({first + a, first + (mirrored ? c : b), first + (mirrored ? b : c)});
    }
  }

  struct Geometry {
    std::vector<Vec3<double>> positions;
    std::vector<std::array<int, 3>> triangles;
  };

  void append(const Geometry& geometry, const Affine& X) { append(geometry.positions, geometry.triangles, X); }

  const Geometry& geometry(const pugi::xml_node& node) {
    const auto [entry, is_new] = geometries_.try_emplace(node.hash_value());
    if (is_new) {
      for (const pugi::xml_node& primitive : node.child("mesh").children()) read_primitive(primitive, entry->second);
    }
    return entry->second;
  }

  /// The positions that <vertices> names: the numbers of a source, in groups of its accessor's stride.
  std::vector<Vec3<double>> read_positions(const pugi::xml_node& vertices) {
    const pugi::xml_node input = vertices.find_child_by_attribute("input", "semantic", "POSITION");
    if (!input) throw MeshError("<vertices> has no input of the semantic POSITION");
    const pugi::xml_node source = target(input, "source");
    const pugi::xml_node accessor = source.child("technique_common").child("accessor");
    const std::vector<double> numbers = numbers_of(accessor ? target(accessor, "source") : source.child("float_array"));
    const unsigned stride = accessor.attribute("stride").as_uint(3);
    const unsigned offset = accessor.attribute("offset").as_uint(0);
    if (stride < 3) throw MeshError("positions have the stride " + std::to_string(stride) + "; expected 3 or more");
    std::vector<Vec3<double>> positions;
    for (std::size_t i = offset; i + 2 < numbers.size(); i += stride) {
      positions.push_back({numbers[i], numbers[i + 1], numbers[i + 2]});
    }
    return positions;
  }

  void read_primitive(const pugi::xml_node& primitive, Geometry& geometry) {
    const std::string_view tag = primitive.name();
    const bool known =
        tag == "triangles" || tag == "polylist" || tag == "polygons" || tag == "trifans" || tag == "tristrips";
    if (!known) return;
    std::size_t width = 0, offset = 0;
    pugi::xml_node vertices;
    for (const pugi::xml_node& input : primitive.children("input")) {
      const std::size_t at = input.attribute("offset").as_uint(0);
      width = std::max(width, at + 1);
      if (std::string_view(input.attribute("semantic").value()) != "VERTEX") continue;
      vertices = target(input, "source");
      offset = at;
    }
    if (!vertices) throw MeshError("<" + std::string(tag) + "> has no input of the semantic VERTEX");
    const int first = static_cast<int>(geometry.positions.size());
    const std::vector<Vec3<double>> positions = read_positions(vertices);
    geometry.positions.insert(geometry.positions.end(), positions.begin(), positions.end());
    if (geometry.positions.size() > kMostVertices) throw MeshError("a geometry has too many vertices");

    std::vector<double> sizes = tag == "polylist" ? numbers_of(primitive.child("vcount")) : std::vector<double>();
    for (const pugi::xml_node& p : primitive.children("p")) {
      const std::vector<int> corners = read_corners(p, width, offset, positions.size());
      if (tag == "triangles") sizes.assign(corners.size() / 3, 3);
      if (tag == "polygons" || tag == "trifans" || tag == "tristrips") sizes = {static_cast<double>(corners.size())};
      add_polygons(corners, sizes, tag == "tristrips", first, geometry);
    }
  }

  std::vector<int> read_corners(const pugi::xml_node& p, std::size_t width, std::size_t offset,
                                std::size_t num_positions) {
    const std::vector<double> numbers = numbers_of(p);
    std::vector<int> corners;
    for (std::size_t i = offset; i < numbers.size(); i += width) {
      if (!(numbers[i] >= 0 && numbers[i] < static_cast<double>(num_positions))) {
        throw MeshError("a face names the vertex " + format_number(numbers[i]) + " of " +
                        std::to_string(num_positions));
      }
      corners.push_back(static_cast<int>(numbers[i]));
    }
    return corners;
  }

  static void add_polygons(const std::vector<int>& corners, const std::vector<double>& sizes, bool is_strip, int first,
                           Geometry& geometry) {
    std::size_t start = 0;
    for (const double size : sizes) {
      if (!(size >= 0 && size <= static_cast<double>(corners.size() - start))) {
        throw MeshError("a face has " + format_number(size) + " corners, but only " +
                        std::to_string(corners.size() - start) + " are left");
      }
      const auto n = static_cast<std::size_t>(size);
      for (std::size_t k = 2; k < n; ++k) {
        // A fan turns about its first corner; every other triangle of a strip is the other way round.
        const std::size_t a = is_strip ? k - 2 + k % 2 : 0;
        const std::size_t b = is_strip ? k - 1 - k % 2 : k - 1;
        geometry.triangles.push_back(
            {first + corners[start + a], first + corners[start + b], first + corners[start + k]});
      }
      start += n;
    }
  }

  pugi::xml_node root_;
  std::map<std::string_view, pugi::xml_node> ids_;
  std::map<std::size_t, Geometry> geometries_;
  std::size_t work_ = 0;
  Mesh mesh_;
};

}  // namespace

Mesh read_dae(std::string_view bytes) {
  try {
    const XmlFile file(bytes);
    if (std::string_view(file.root().name()) != "COLLADA")
      throw MeshError("not a COLLADA file: its root is not <COLLADA>");
    return DaeReader(file.root()).read();
  } catch (const XmlError& error) {
    throw MeshError("line " + std::to_string(error.line()) + ": " + error.what());
  }
}

}  // namespace manyhands::io
