// Meshes written here, read back: formats, scales, units, axes, and what is no mesh.
#include <array>
#include <cstdint>
#include <cstring>

#include "manyhands/math/vec3.h"
#include "manyhands/model/io/mesh/mesh_file.h"
#include "tests/model/urdf_testing.h"

namespace manyhands::testing {
namespace {

/// Volume enclosed, positive if the triangles face outwards: the sum of signed tetrahedra.
double volume(const Mesh& mesh) {
  double sum = 0;
  const auto at = [&](int i) {
    const Vec3<float>& v = mesh.vertices[static_cast<std::size_t>(i)];
    return Vec3<double>{v.x, v.y, v.z};
  };
  for (const auto& [a, b, c] : mesh.triangles) sum += dot(at(a), cross(at(b), at(c))) / 6;
  return sum;
}

constexpr float kFacets[4][3][3] = {{{0, 0, 0}, {0, 1, 0}, {1, 0, 0}},
                                    {{0, 0, 0}, {1, 0, 0}, {0, 0, 1}},
                                    {{0, 0, 0}, {0, 0, 1}, {0, 1, 0}},
                                    {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};

std::string ascii_stl() {
  std::string text = "solid corner\n";
  for (const auto& facet : kFacets) {
    text += "facet normal 0 0 0\n outer loop\n";
    for (const auto& v : facet) {
      text += "  vertex " + std::to_string(v[0]) + " " + std::to_string(v[1]) + " " + std::to_string(v[2]) + "\n";
    }
    text += " endloop\nendfacet\n";
  }
  return text + "endsolid corner\n";
}

std::string binary_stl() {
  std::string bytes = "solid, says the header, but it is not ASCII";
  bytes.resize(84, '\0');
  bytes[80] = 4;
  for (const auto& facet : kFacets) {
    bytes.append(12, '\0');
    bytes.append(reinterpret_cast<const char*>(facet), sizeof facet);
    bytes.append(2, '\0');
  }
  return bytes;
}

/// The same corner, once as it is and once moved by a node, in the file's unit and axes.
std::string dae(const std::string& asset, const std::string& node) {
  return "<?xml version=\"1.0\"?><COLLADA version=\"1.4.1\"><asset>" + asset +
         "</asset><library_geometries><geometry id=\"g\"><mesh><source id=\"p\"><float_array id=\"pa\" count=\"12\">"
         "0 0 0 1 0 0 0 1 0 0 0 1</float_array><technique_common><accessor source=\"#pa\" count=\"4\" stride=\"3\"/>"
         "</technique_common></source><vertices id=\"v\"><input semantic=\"POSITION\" source=\"#p\"/></vertices>"
         "<triangles count=\"3\"><input semantic=\"VERTEX\" source=\"#v\" offset=\"0\"/>"
         "<input semantic=\"NORMAL\" source=\"#n\" offset=\"1\"/><p>0 0 2 0 1 0 0 0 1 0 3 0 0 0 3 0 2 0</p></triangles>"
         "<polylist count=\"1\"><input semantic=\"VERTEX\" source=\"#v\" offset=\"0\"/><vcount>3</vcount><p>1 2 3</p>"
         "</polylist></mesh></geometry></library_geometries><library_visual_scenes><visual_scene id=\"s\">" +
         node + "</visual_scene></library_visual_scenes><scene><instance_visual_scene url=\"#s\"/></scene></COLLADA>";
}

/// The corner with normals and texture coordinates, which are passed over.
std::string msh() {
  const std::array<std::int32_t, 4> counts{4, 4, 4, 4};
  const std::array<float, 12 + 12 + 8> numbers{0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
  const std::array<std::int32_t, 12> faces{0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};
  std::string bytes;
  bytes.append(reinterpret_cast<const char*>(&counts), sizeof counts);
  bytes.append(reinterpret_cast<const char*>(&numbers), sizeof numbers);
  return bytes.append(reinterpret_cast<const char*>(&faces), sizeof faces);
}

constexpr const char* kPlainNode = "<node><instance_geometry url=\"#g\"/></node>";

TEST(MeshFile, EveryFormatGivesTheSameCorner) {
  const ScratchFolder folder;
  const std::pair<const char*, std::string> files[] = {{"a.stl", ascii_stl()},
                                                       {"b.STL", binary_stl()},
                                                       {"c.obj", std::string(kTetrahedronObj)},
                                                       {"d.dae", dae("<up_axis>Z_UP</up_axis>", kPlainNode)},
                                                       {"e.msh", msh()}};
  for (const auto& [name, bytes] : files) {
    const Mesh mesh = load_mesh(folder.write(name, bytes));
    EXPECT_EQ(mesh.triangles.size(), 4u) << name;
    EXPECT_NEAR(volume(mesh), 1.0 / 6, 1e-7) << name;
    EXPECT_TRUE(contains(mesh.source, name));
  }
}

TEST(MeshFile, WeldsTheVerticesOfAnStl) { EXPECT_EQ(io::read_stl(binary_stl()).vertices.size(), 4u); }

TEST(MeshFile, ScaleMayMirror) {
  const ScratchFolder folder;
  const auto file = folder.write("a.stl", ascii_stl());
  EXPECT_NEAR(volume(load_mesh(file, {2, 3, 4})), 4, 1e-6);
  EXPECT_NEAR(volume(load_mesh(file, {-2, 3, 4})), 4, 1e-6);  // still facing outwards
}

TEST(MeshFile, DaeUnitAxesAndNodes) {
  // In a file with y up, a step of (1, 2, 3) centimetres is (1, -3, 2) with z up.
  const std::string moved = "<node><translate>1 2 3</translate><instance_geometry url=\"#g\"/></node>";
  const Mesh y_up = io::read_dae(dae("<unit meter=\"0.01\"/>", moved));
  EXPECT_FLOAT_EQ(y_up.vertices[0].x, 0.01f);
  EXPECT_FLOAT_EQ(y_up.vertices[0].y, -0.03f);
  EXPECT_FLOAT_EQ(y_up.vertices[0].z, 0.02f);
  EXPECT_NEAR(volume(y_up), 1e-6 / 6, 1e-12);
  const Mesh x_up = io::read_dae(dae("<up_axis>X_UP</up_axis>", moved));
  EXPECT_FLOAT_EQ(x_up.vertices[0].z, 1);
  EXPECT_FLOAT_EQ(x_up.vertices[0].x, -2);
  EXPECT_NEAR(volume(x_up), 1.0 / 6, 1e-6);

  const std::string nested =
      "<node><rotate>0 0 1 90</rotate><translate>1 0 0</translate><node><matrix>1 0 0 0 0 1 0 0 0 0 -1 5 0 0 0 "
      "1</matrix>"
      "<scale>2 2 2</scale><instance_geometry url=\"#g\"/></node></node>";
  const Mesh mesh = io::read_dae(dae("<up_axis>Z_UP</up_axis>", nested));
  EXPECT_NEAR(mesh.vertices[0].x, 0, 1e-6);  // (1, 0, 5) turned a quarter about z
  EXPECT_NEAR(mesh.vertices[0].y, 1, 1e-6);
  EXPECT_NEAR(mesh.vertices[0].z, 5, 1e-6);
  EXPECT_GT(volume(mesh), 0);  // the mirroring matrix turns no triangle inside out
}

TEST(MeshFile, DaeNodesCannotMultiplyWithoutEnd) {
  std::string library;
  for (int i = 0; i < 40; ++i) {
    const std::string next = "<instance_node url=\"#n" + std::to_string(i + 1) + "\"/>";
    library += "<node id=\"n" + std::to_string(i) + "\">" + next + next + "</node>";
  }
  const std::string bomb = library + "<node id=\"n40\"><instance_geometry url=\"#g\"/></node>";
  EXPECT_THROW((void)io::read_dae(dae("", bomb)), MeshError);
  const std::string circle = "<node id=\"a\"><instance_node url=\"#a\"/></node>";
  EXPECT_THROW((void)io::read_dae(dae("", circle)), MeshError);
}

TEST(MeshFile, SaysWhatIsNoMesh) {
  const ScratchFolder folder;
  const std::pair<const char*, std::string> files[] = {
      {"a.stl", "not a mesh"},
      {"short.stl", binary_stl().substr(0, 200)},
      {"cut.stl", ascii_stl().substr(0, 120)},
      {"word.stl", "solid x facet outer loop vertex 1 2 z"},
      {"nan.obj", "v nan 0 0\n"},
      {"index.obj", "v 0 0 0\nf 1 2 3\n"},
      {"fraction.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2.5 3\n"},
      {"huge.obj", "v 1e200 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"},
      {"empty.obj", ""},
      {"a.dae", "<COLLADA>"},
      {"b.dae", "<robot/>"},
      {"c.dae", dae("<up_axis>UP</up_axis>", kPlainNode)},
      {"d.dae", dae("<unit meter=\"0\"/>", kPlainNode)},
      {"e.dae", dae("", "<node><instance_geometry url=\"#none\"/></node>")},
      {"a.ply", "ply"},
      {"empty.msh", ""},
      {"cut.msh", msh().substr(0, 100)},
      {"longer.msh", msh() + "x"},
      {"negative.msh", "\xff\xff\xff\xff" + msh().substr(4)},
      {"corner.msh", msh().replace(msh().size() - 4, 1, "\x07")}};
  for (const auto& [name, bytes] : files) {
    try {
      (void)load_mesh(folder.write(name, bytes));
      ADD_FAILURE() << name << " was read";
    } catch (const MeshError& error) {
      EXPECT_PRED2(contains, error.what(), name);
    }
  }
  EXPECT_THROW((void)load_mesh(folder.path() / "none.stl"), MeshError);
}

TEST(MeshFile, TheLoaderSharesMeshesAndDropsBrokenOnes) {
  const ScratchFolder folder;
  folder.write("m.obj", kTetrahedronObj);
  folder.write("bad.obj", "f 1 2 3");
  const auto geom = [](const std::string& attributes) {
    return "<visual><geometry><mesh " + attributes + "/></geometry></visual>";
  };
  const auto file = folder.write(
      "r.urdf", robot(link("a", std::string(kInertial) + geom("filename=\"m.obj\"") + geom("filename=\"m.obj\"") +
                                    geom("filename=\"m.obj\" scale=\"2 2 2\"") + geom("filename=\"bad.obj\""))));
  const LoadedModel loaded = load_urdf(file);
  EXPECT_EQ(loaded.model.geoms().size(), 3u);
  EXPECT_EQ(loaded.model.meshes().size(), 2u);
  EXPECT_NEAR(volume(loaded.model.meshes()[1]), 8.0 / 6, 1e-6);
  ASSERT_EQ(loaded.report.notes.size(), 1u);
  EXPECT_PRED2(contains, loaded.report.notes[0].message, "line 1: the face's corner '1' is none of the 0 vertices");
  const LoadedModel bare = load_urdf(file, {.load_meshes = false});
  EXPECT_TRUE(bare.model.geoms().empty());
  EXPECT_PRED2(contains, bare.report.to_string(), "4 geoms with meshes left out, as asked");
}

}  // namespace
}  // namespace manyhands::testing
