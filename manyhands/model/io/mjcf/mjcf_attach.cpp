#include "manyhands/model/io/mjcf/mjcf_attach.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <string_view>

namespace manyhands::io {

namespace {

constexpr std::array<std::string_view, 37> kNames{
    "name",    "class",         "childclass", "body",     "body1",    "body2",   "joint",   "joint1",
    "joint2",  "jointinparent", "geom",       "geom1",    "geom2",    "site",    "site1",   "site2",
    "refsite", "slidersite",    "cranksite",  "sidesite", "tendon",   "tendon1", "tendon2", "mesh",
    "hfield",  "material",      "texture",    "target",   "actuator", "objname", "refname", "cam",
    "camera",  "sensor",        "flex",       "skin",     "key"};
constexpr std::array<std::string_view, 7> kNameless{"compiler", "option",    "size",  "statistic",
                                                    "visual",   "extension", "attach"};

bool is_one_of(const auto& list, std::string_view word) { return std::ranges::find(list, word) != list.end(); }

void name_by_default(pugi::xml_node node) {
  const std::string_view tag = node.name();
  if (tag == "default" && !node.attribute("class")) node.append_attribute("class").set_value("main");
  const bool is_asset = tag == "mesh" || tag == "hfield" || tag == "texture" || tag == "material";
  if (is_asset && std::string_view(node.parent().name()) == "asset" && !node.attribute("name") &&
      node.attribute("file")) {
    node.append_attribute("name").set_value(std::filesystem::path(node.attribute("file").value()).stem().c_str());
  }
}

}  // namespace

void add_prefix(const std::string& prefix, pugi::xml_node root) {
  struct Walker : pugi::xml_tree_walker {
    bool for_each(pugi::xml_node& node) override {
      if (is_one_of(kNameless, node.name())) return true;
      name_by_default(node);
      for (pugi::xml_attribute attribute : node.attributes()) {
        const std::string_view value = attribute.value();
        if (!is_one_of(kNames, attribute.name()) || value.empty() || value == "world") continue;
        attribute.set_value((prefix + std::string(value)).c_str());
      }
      return true;
    }
    std::string prefix;
  } walker;
  walker.prefix = prefix;
  root.traverse(walker);
}

}  // namespace manyhands::io
