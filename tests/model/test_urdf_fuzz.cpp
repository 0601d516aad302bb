// Damaged files by the thousand: they load or give the one error, and nothing else happens. The same cases every time;
// MANYHANDS_FUZZ_ROUNDS asks for more of them.
#include <cmath>

#include "manyhands/model/io/mesh/mesh_file.h"
#include "manyhands/model/io/sdf/sdf.h"
#include "tests/model/mutator.h"
#include "tests/model/urdf_testing.h"

namespace manyhands::testing {
namespace {

constexpr std::string_view kUrdf = R"(<?xml version="1.0"?>
<robot name="seed">
  <material name="grey"><color rgba="0.5 0.5 0.5 1"/><texture filename="none.png"/></material>
  <link name="base"/>
  <link name="arm">
    <inertial><origin xyz="0 0 0.1" rpy="0 0.1 0"/><mass value="1.5"/>
      <inertia ixx="0.1" ixy="0" ixz="0" iyy="0.2" iyz="0.01" izz="0.25"/></inertial>
    <visual name="shell"><origin xyz="0 0 1"/><geometry><box size="1 2 3"/></geometry><material name="grey"/></visual>
    <collision><geometry><capsule radius="0.1" length="0.5"/></geometry></collision>
    <contact><lateral_friction value="1.0"/><stiffness value="30000"/><damping value="1000"/></contact>
  </link>
  <link name="hand"><collision><geometry><mesh filename="package://none/m.stl" scale="1 1 1"/></geometry></collision></link>
  <link name="tip"><visual><geometry><plane normal="0 0 1"/></geometry></visual></link>
  <joint name="shoulder" type="revolute"><origin xyz="0 0 0.3" rpy="-1.57 0 0"/><parent link="base"/><child link="arm"/>
    <axis xyz="0 0 1"/><limit lower="-1" upper="1" effort="10" velocity="2"/><dynamics damping="0.1" friction="0.2"/></joint>
  <joint name="wrist" type="planar"><parent link="arm"/><child link="hand"/><axis xyz="0 1 0"/></joint>
  <joint name="slide" type="prismatic"><parent link="hand"/><child link="tip"/><axis xyz="0 0 0"/>
    <limit lower="0" upper="1" effort="1" velocity="1"/><mimic joint="shoulder" multiplier="2" offset="0"/></joint>
  <transmission name="t"/><gazebo/>
</robot>)";

constexpr std::string_view kSdf = R"(<sdf version="1.7"><world name="w"><gravity>0 0 -9.8</gravity>
<physics type="ode"><max_step_size>0.001</max_step_size></physics><frame name="f"><pose>1 2 3 0 0 0</pose></frame>
<include><uri>model://none</uri><pose relative_to="f">0 0 1 0 0 0</pose></include>
<model name="seed" placement_frame="base"><pose>0 0 1 0 0.1 0</pose><self_collide>1</self_collide>
<link name="base"><inertial><pose>0 0 0.1 0 0 0</pose><mass>2</mass><inertia><ixx>0.1</ixx><iyy>0.2</iyy><izz>0.25</izz><ixy>0</ixy></inertia></inertial>
<collision name="c"><geometry><box><size>1 2 3</size></box></geometry><surface><friction><ode><mu>0.5</mu></ode></friction><contact><collide_bitmask>0x02</collide_bitmask></contact></surface></collision>
<visual name="v"><geometry><mesh><uri>m.obj</uri><scale>1 1 1</scale></mesh></geometry><material><diffuse>1 0 0 1</diffuse></material></visual></link>
<link name="arm"><pose relative_to="shoulder">0 0 0 0 0 0</pose><gravity>0</gravity><collision name="e"><geometry><ellipsoid><radii>1 2 3</radii></ellipsoid></geometry></collision></link>
<link name="hand"><pose degrees="true">0 0 2 90 0 0</pose><contact><lateral_friction>1</lateral_friction></contact></link>
<joint name="shoulder" type="revolute"><pose relative_to="base">0 0 1 0 0 0</pose><parent>base</parent><child>arm</child><axis><xyz expressed_in="__model__">0 1 0</xyz><limit><lower>-1</lower><upper>1e16</upper><effort>-1</effort></limit><dynamics><damping>1</damping><spring_stiffness>2</spring_stiffness></dynamics></axis></joint>
<joint name="wrist" type="universal"><parent>arm</parent><child>hand</child><axis><xyz>1 0 0</xyz></axis><axis2><xyz>0 1 0</xyz></axis2></joint>
<joint name="loop" type="ball"><parent>base</parent><child>hand</child></joint>
<model name="inner"><link name="tip"/></model><joint name="stuck" type="fixed"><parent>hand</parent><child>inner::tip</child></joint>
</model><model name="other"><static>true</static><link name="l"><collision name="p"><geometry><plane><normal>0 0 1</normal></plane></geometry></collision></link></model></world></sdf>)";

constexpr std::string_view kDae = R"(<COLLADA version="1.4.1"><asset><unit meter="0.01"/><up_axis>Y_UP</up_axis></asset>
<library_geometries><geometry id="g"><mesh><source id="p"><float_array id="pa" count="12">0 0 0 1 0 0 0 1 0 0 0 1</float_array>
<technique_common><accessor source="#pa" count="4" stride="3" offset="0"/></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="2"><input semantic="VERTEX" source="#v" offset="0"/><input semantic="NORMAL" source="#p" offset="1"/>
<p>0 0 2 0 1 0 0 0 1 0 3 0</p></triangles>
<polylist count="1"><input semantic="VERTEX" source="#v" offset="0"/><vcount>4</vcount><p>0 1 2 3</p></polylist>
<tristrips count="1"><input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2 3</p></tristrips></mesh></geometry></library_geometries>
<library_nodes><node id="s"><instance_geometry url="#g"/></node></library_nodes>
<library_visual_scenes><visual_scene id="w"><node><translate>1 2 3</translate><rotate>0 0 1 90</rotate><scale>2 2 2</scale>
<node id="b"><matrix>1 0 0 5 0 1 0 6 0 0 1 7 0 0 0 1</matrix><instance_geometry url="#g"/><instance_node url="#s"/></node></node>
</visual_scene></library_visual_scenes><scene><instance_visual_scene url="#w"/></scene></COLLADA>)";

constexpr std::string_view kStl =
    "solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1e0 0\nendloop\nendfacet\nendsolid "
    "s\n";

std::string binary_stl() {
  std::string bytes(84 + 3 * 50, '\0');
  bytes[80] = 3;
  for (std::size_t i = 84; i < bytes.size(); ++i) bytes[i] = static_cast<char>(i * 37 % 61);
  return bytes;
}

std::string msh() {
  std::string bytes(16 + 3 * 12 + 12, '\0');
  bytes[0] = 3;
  bytes[12] = 1;
  for (std::size_t i = 0; i < 3; ++i) bytes[16 + 36 + 4 * i] = static_cast<char>(i);
  return bytes;
}

/// One node, moved and scaled: a triangle (0 0 0), (1 0 0), (0 1 0).
constexpr std::string_view kTriangleGltf = R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],
"nodes":[{"mesh":0,"translation":[1,2,3],"scale":[2,2,2],"rotation":[0,0,0,1],"children":[1]},{"name":"n","matrix":[1,0,0,0,0,1,0,0,0,0,1,0,5,0,0,1],"mesh":0}],
"meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1,"mode":4}]}],
"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"},{"bufferView":1,"componentType":5123,"count":3,"type":"SCALAR"}],
"bufferViews":[{"buffer":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":6}],
"buffers":[{"byteLength":42,"uri":"data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAABAAIA"}]})";

std::string as_glb(std::string_view json) {
  const auto word = [](std::size_t n) {
    std::string bytes(4, '\0');
    for (std::size_t i = 0; i < 4; ++i) bytes[i] = static_cast<char>((n >> (8 * i)) & 0xff);
    return bytes;
  };
  return "glTF" + word(2) + word(json.size() + 20) + word(json.size()) + "JSON" + std::string(json);
}

void expect_whole(const Model& model) {
  for (const Link& link : model.links()) {
    ASSERT_TRUE(std::isfinite(link.inertial.mass) && link.inertial.mass >= 0);
    ASSERT_TRUE(link.body.is_valid());
  }
  for (const Joint& joint : model.joints()) {
    ASSERT_NEAR(norm(joint.axis), 1, 1e-9);
    ASSERT_LE(joint.limits.lower, joint.limits.upper);
  }
  for (const Body& body : model.bodies()) ASSERT_TRUE(std::isfinite(body.inertia.I.xx + body.X_PF.p.x));
}

TEST(UrdfFuzz, RobotsLoadOrGiveTheOneError) {
  int loaded = 0, refused = 0;
  for (unsigned seed = 0; seed < rounds(6000); ++seed) {
    const std::string text = Mutator(seed).mutated(kUrdf);
    try {
      expect_whole(
          load_urdf_string(text, "fuzz.urdf", ".", {.fixed_base = seed % 2 == 0, .bullet = seed % 3 == 0}).model);
      ++loaded;
    } catch (const UrdfError& error) {
      ASSERT_TRUE(std::string(error.what()).starts_with("fuzz.urdf:"));
      ++refused;
    }
  }
  // The mutations must neither break everything nor nothing.
  EXPECT_GT(loaded, refused / 20);
  EXPECT_GT(refused, loaded / 20);
}

TEST(UrdfFuzz, SdfWorldsLoadOrGiveTheOneError) {
  const auto load = [](const std::string& text) {
    std::vector<LoadedModel> loaded = load_sdf_string(text, "fuzz.sdf", ".");
    for (const LoadedModel& part : loaded) expect_whole(part.model);
    expect_whole(joined(std::move(loaded)).model);
  };
  load(std::string(kSdf));
  expect_read_or_refused<SdfError>(kSdf, rounds(6000), load);
}

TEST(UrdfFuzz, GltfNodesArePlacedWithZUp) {
  for (const std::string& bytes : {std::string(kTriangleGltf), as_glb(kTriangleGltf)}) {
    const std::vector<Mesh> parts = io::read_gltf_objects(bytes, {});
    ASSERT_EQ(parts.size(), 2u);
    EXPECT_EQ(parts[1].source, "n");
    const Vec3<float> a = parts[0].vertices[2], b = parts[1].vertices[1];
    EXPECT_EQ((std::array{a.x, a.y, a.z}), (std::array{1.0f, -3.0f, 4.0f}));   // (1, 2 + 2, 3), y up
    EXPECT_EQ((std::array{b.x, b.y, b.z}), (std::array{13.0f, -3.0f, 2.0f}));  // 1 + 2 (5 + 1)
    EXPECT_EQ(parts[0].triangles[0], (std::array{0, 1, 2}));
    EXPECT_EQ(io::read_gltf(bytes, {}).triangles.size(), 2u);
  }
}

TEST(UrdfFuzz, GltfFilesLoadOrGiveTheOneError) {
  const auto read_whole = [](const std::string& mutant) {
    const Mesh mesh = io::read_gltf(mutant, [](const std::string&) { return std::string(48, '\1'); });
    for (const auto& triangle : mesh.triangles) {
      for (const int i : triangle) ASSERT_TRUE(i >= 0 && i < std::ssize(mesh.vertices));
    }
  };
  expect_read_or_refused<MeshError>(kTriangleGltf, rounds(6000), read_whole);
  expect_read_or_refused<MeshError>(as_glb(kTriangleGltf), rounds(3000), read_whole);
}

TEST(UrdfFuzz, MeshesLoadOrGiveTheOneError) {
  const std::string binary = binary_stl(), packed = msh();
  const std::pair<std::string_view, Mesh (*)(std::string_view)> formats[] = {{kDae, io::read_dae},
                                                                             {kStl, io::read_stl},
                                                                             {binary, io::read_stl},
                                                                             {kTetrahedronObj, io::read_obj},
                                                                             {packed, io::read_msh}};
  for (const auto& [bytes, read] : formats) {
    const auto read_whole = [read = read](const std::string& mutant) {
      const Mesh mesh = read(mutant);
      for (const auto& triangle : mesh.triangles) {
        for (const int i : triangle) ASSERT_TRUE(i >= 0 && i < std::ssize(mesh.vertices));
      }
    };
    expect_read_or_refused<MeshError>(bytes, rounds(3000), read_whole);
  }
}

}  // namespace
}  // namespace manyhands::testing
