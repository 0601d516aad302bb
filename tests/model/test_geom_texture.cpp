// Textures that URDF and MJCF files name: kept where they can be shown, noted where they cannot, never in the way.
#include <algorithm>
#include <limits>

#include "manyhands/model/model_builder.h"
#include "tests/model/mjcf_testing.h"

namespace manyhands::testing {
namespace {

constexpr std::string_view kBytes = "what an image holds does not matter to loaders";

std::string box(const std::string& name, const std::string& material) {
  return "<visual name=\"" + name + "\"><geometry><box size=\"1 1 1\"/></geometry>" + material + "</visual>";
}

const Geom& geom_of(const LoadedModel& loaded, const std::string& name) {
  return *std::ranges::find(loaded.model.geoms(), name, &Geom::name);
}

TEST(GeomTexture, OfUrdfIsFoundAsMeshesAre) {
  const ScratchFolder folder;
  const std::string package = folder.write("robots/tex/wood.png", kBytes).string();
  (void)folder.write("robots/package.xml", "<package><name>robots</name></package>");
  const std::string text =
      robot("<material name=\"wood\"><texture filename=\"package://robots/tex/wood.png\"/></material>\n" +
            link("a", std::string(kInertial) + box("named", "<material name=\"wood\"/>") +
                          box("own",
                              "<material name=\"\"><color rgba=\"1 0 0 1\"/>"
                              "<texture filename=\"../tex/wood.png\"/></material>") +
                          box("none",
                              "<material name=\"\"><color rgba=\"0 1 0 1\"/><texture filename=\"\"/>"
                              "</material>")));
  (void)folder.write("robots/urdf/r.urdf", text);
  const LoadedModel loaded = load_urdf(folder.path() / "robots/urdf/r.urdf");
  EXPECT_TRUE(loaded.report.empty()) << loaded.report.to_string();
  for (const char* const name : {"named", "own"}) {
    ASSERT_TRUE(geom_of(loaded, name).texture) << name;
    EXPECT_EQ(geom_of(loaded, name).texture->file, package);
    EXPECT_EQ(geom_of(loaded, name).texture->repeat, (std::array{1.0f, 1.0f}));
  }
  EXPECT_EQ(geom_of(loaded, "named").rgba, (std::array{1.0f, 1.0f, 1.0f, 1.0f}));
  EXPECT_EQ(geom_of(loaded, "own").rgba, (std::array{1.0f, 0.0f, 0.0f, 1.0f}));
  EXPECT_FALSE(geom_of(loaded, "none").texture);
}

TEST(GeomTexture, OfUrdfThatCannotBeReadIsNoted) {
  const ScratchFolder folder;
  (void)folder.write("secret.png", kBytes);
  for (const char* const file : {"none.png", "../secret.png", "http://a.b/c.png", "package://nowhere/c.png", "."}) {
    const std::string text =
        robot(link("a", std::string(kInertial) + box("box", "<material name=\"m\"><texture filename=\"" +
                                                                std::string(file) + "\"/></material>")));
    const LoadedModel loaded = load_urdf(folder.write("urdf/r.urdf", text));
    EXPECT_FALSE(geom_of(loaded, "box").texture) << file;
    EXPECT_EQ(loaded.report.notes.size(), 1u) << loaded.report.to_string();
    EXPECT_PRED2(contains, loaded.report.to_string(), "ignored: link 'a': texture '" + std::string(file) + "'");
    EXPECT_PRED2(contains, loaded.report.to_string(), "the colour alone is shown");
  }
}

std::string scene(const std::string& textures, const std::string& geom, const std::string& material) {
  return mujoco("<compiler texturedir=\"tex\"/><asset>" + textures + "<material name=\"m\" texture=\"t\" " + material +
                "/></asset><worldbody><geom name=\"g\" material=\"m\" " + geom + "/></worldbody>");
}

TEST(GeomTexture, OfMjcfFilesLiesInTheirFolder) {
  const ScratchFolder folder;
  const std::string file = folder.write("tex/t.png", kBytes).string();
  const LoadedModel loaded = load_mjcf(folder.write(
      "s.xml", scene("<texture type=\"2d\" file=\"t.png\"/>", "size=\"1\"", "texrepeat=\"2 3\" rgba=\"1 1 0 1\"")));
  ASSERT_TRUE(geom_of(loaded, "g").texture) << loaded.report.to_string();
  EXPECT_EQ(geom_of(loaded, "g").texture->file, file);
  EXPECT_EQ(geom_of(loaded, "g").texture->repeat, (std::array{2.0f, 3.0f}));
  EXPECT_EQ(geom_of(loaded, "g").rgba, (std::array{1.0f, 1.0f, 0.0f, 1.0f}));
  EXPECT_TRUE(loaded.report.empty()) << loaded.report.to_string();
}

TEST(GeomTexture, OfMjcfByRuleIsChecksOfTwoColoursOrOne) {
  const auto of = [](const std::string& builtin) {
    const LoadedModel loaded = load_scene(scene(
        "<texture name=\"t\" builtin=\"" + builtin + "\" rgb1=\"1 0 0\" rgb2=\"0 0 1\" width=\"8\" height=\"8\"/>",
        "size=\"1\"", "texrepeat=\"5 5\""));
    EXPECT_TRUE(loaded.report.empty()) << loaded.report.to_string();
    return geom_of(loaded, "g").texture.value();
  };
  constexpr std::array kRed{1.0f, 0.0f, 0.0f}, kBlue{0.0f, 0.0f, 1.0f};
  EXPECT_EQ(of("checker").rgb, (std::array{kRed, kBlue}));
  EXPECT_EQ(of("flat").rgb, (std::array{kRed, kRed}));
  EXPECT_EQ(of("checker").repeat, (std::array{1.0f, 1.0f}));  // a cube's sides are not repeated
}

TEST(GeomTexture, OfMjcfPlanesIsCountedInMetres) {
  const auto repeat = [](const std::string& size, const std::string& uniform) {
    const LoadedModel loaded =
        load_scene(scene("<texture name=\"t\" type=\"2d\" builtin=\"checker\"/>",
                         "type=\"plane\" size=\"" + size + "\"", "texrepeat=\"8 6\" texuniform=\"" + uniform + "\""));
    return geom_of(loaded, "g").texture.value().repeat;
  };
  EXPECT_EQ(repeat("2 1 0.1", "false"), (std::array{2.0f, 3.0f}));  // 8 on 4 m, 6 on 2 m
  EXPECT_EQ(repeat("2 1 0.1", "true"), (std::array{4.0f, 3.0f}));   // on every 2 m
  EXPECT_EQ(repeat("0 0 0.1", "false"), (std::array{4.0f, 3.0f}));  // without an end
  EXPECT_EQ(repeat("1e-12 1e12 1", "false"), (std::array{kMostRepeats, 1 / kMostRepeats}));
}

TEST(GeomTexture, OfMjcfThatCannotBeShownIsNoted) {
  const auto report = [](const std::string& texture, const std::string& material = "") {
    const LoadedModel loaded = load_scene(scene(texture, "size=\"1\"", material));
    EXPECT_EQ(geom_of(loaded, "g").texture.has_value(), !material.empty());
    return loaded.report.to_string();
  };
  EXPECT_PRED2(contains, report("<texture name=\"t\" file=\"none.png\"/>"), "ignored: texture 't': there is no file");
  EXPECT_PRED2(contains, report("<texture name=\"t\" file=\"../../../../../../../../../../x.png\"/>"), "lies outside");
  EXPECT_PRED2(contains, report("<texture name=\"t\" builtin=\"gradient\"/>"), "gradients are not read");
  EXPECT_PRED2(contains, report("<texture name=\"t\" fileright=\"a.png\"/>"), "neither 'builtin' nor 'file'");
  EXPECT_PRED2(contains, report("<texture name=\"t\" type=\"skybox\" builtin=\"checker\"/>"), "the skybox");
  EXPECT_PRED2(contains, report("<texture name=\"t\" type=\"2d\" builtin=\"checker\"/>", "texrepeat=\"0 -1\""),
               "repaired: material 'm': 'texrepeat' 0 is not above 0");
  // Skies have no name.
  EXPECT_EQ(scene_error(scene("<texture type=\"skybox\" builtin=\"gradient\"/><texture name=\"t\" builtin=\"flat\"/>"
                              "<texture type=\"skybox\" builtin=\"gradient\"/>",
                              "size=\"1\"", "")),
            "");
}

TEST(GeomTexture, OfMjcfMalformedIsRefused) {
  const auto error = [](const std::string& texture, const std::string& material = "") {
    return scene_error(scene(texture, "size=\"1\"", material));
  };
  EXPECT_PRED2(contains, error(""), "material 'm': there is no texture 't'");
  EXPECT_PRED2(contains, error("<texture name=\"t\" builtin=\"chess\"/>"), "holds 'chess'; expected one of none");
  EXPECT_PRED2(contains, error("<texture name=\"t\" builtin=\"flat\" rgb1=\"1 red 0\"/>"), "holds '1 red 0'");
  EXPECT_PRED2(contains, error("<texture name=\"t\" builtin=\"flat\"/><texture name=\"t\" builtin=\"flat\"/>"),
               "texture 't': the name is taken");
  EXPECT_PRED2(contains, error("<texture name=\"t\" type=\"2d\" builtin=\"flat\"/>", "texrepeat=\"much\""),
               "holds 'much'");
}

TEST(GeomTexture, OfBuildersIsRepeatedMoreThanNotAtAll) {
  ModelBuilder builder("m");
  const auto with = [&](float repeat) {
    return Geom{
        .link = builder.world(), .shape = {.size = {1, 0, 0}}, .texture = GeomTexture{.repeat = {1.0f, repeat}}};
  };
  EXPECT_NO_THROW((void)builder.add_geom(with(2)));
  for (const float wrong : {0.0f, -1.0f, std::numeric_limits<float>::quiet_NaN(), 1e6f}) {
    EXPECT_THROW((void)builder.add_geom(with(wrong)), ModelError) << wrong;
  }
}

}  // namespace
}  // namespace manyhands::testing
