// An MJCF file in the making: what is shared by the writers of its sections.
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "manyhands/model/io/save/asset_files.h"
#include "manyhands/model/io/save/save_notes.h"
#include "manyhands/model/io/save/xml_out.h"

namespace manyhands::io {

/// A body that is written, and where its readers find it at the start.
struct MjcfPlace {
  pugi::xml_node node;
  Transform<double> X_WB = Transform<double>::identity();
};

struct MjcfWriter {
  MjcfWriter(const Model& described, SaveNotes& save_notes, AssetFiles* asset_files);

  const Model& model;
  SaveNotes& notes;
  AssetFiles* files;  ///< none: everything lies in the text
  pugi::xml_document document;
  pugi::xml_node root, assets, world;
  SavedNames names;
  std::map<LinkId, MjcfPlace> bodies;  ///< by the link that they are
  std::vector<LinkId> carried_by;      ///< by link: the body that it is written as; invalid for links that are left out
  std::vector<std::string> geom_names;       ///< by geom, as written; empty for those that are left out
  std::vector<std::pair<int, int>> filters;  ///< by geom: contype and conaffinity
  std::map<int, std::string> meshes, height_fields;
  std::map<std::string, std::string> textures, materials;  ///< by all that they say
  std::vector<std::vector<int>> frames_of;                 ///< by link: the frames that are written on it

  [[nodiscard]] const MjcfPlace& place_of(LinkId link) const { return bodies.at(carried_by[link.index()]); }
  /// The name of a link's body.
  [[nodiscard]] const std::string& body(LinkId link) const { return model.link(carried_by[link.index()]).name; }
};

// The writers, in the order in which they run.
void write_settings(MjcfWriter& writer);
void choose_filters(MjcfWriter& writer);
void write_world(MjcfWriter& writer);
void write_contacts(MjcfWriter& writer);
void write_tendons(MjcfWriter& writer);
void write_equalities(MjcfWriter& writer);
void write_actuators(MjcfWriter& writer);
void write_sensors(MjcfWriter& writer);
void write_keyframes(MjcfWriter& writer);

/// pos and quat, where they are not those of no pose at all.
void write_pose(pugi::xml_node node, const Vec3<double>& p, const Quat<double>& q);
void write_pose(pugi::xml_node node, const Transform<double>& X);
/// The name of a site on the link at X, or one that is turned otherwise at p: one that is written, or a new one.
[[nodiscard]] std::string site_at(MjcfWriter& writer, LinkId link, const Transform<double>& X,
                                  const std::string& wanted);
[[nodiscard]] std::string site_at(MjcfWriter& writer, LinkId link, const Vec3<double>& p, const std::string& wanted);
/// Where its readers find the length of a tendon at the start.
[[nodiscard]] double length_at_start(const MjcfWriter& writer, const Tendon& tendon);
/// wxyz: the only place where MJCF's order is made.
[[nodiscard]] std::array<double, 4> wxyz(const Quat<double>& q);

void write_geom(MjcfWriter& writer, pugi::xml_node body, GeomId id);
/// friction and condim.
void write_surface(pugi::xml_node node, const SurfaceMaterial& surface, bool is_pair);
/// Notes what of the surface MJCF cannot say.
void note_surface(MjcfWriter& writer, const SurfaceMaterial& surface, const std::string& element);
[[nodiscard]] const std::string& mesh_asset(MjcfWriter& writer, MeshId id);
[[nodiscard]] const std::string& height_field_asset(MjcfWriter& writer, HeightFieldId id);
/// The material that shows the texture; empty if it cannot be shown.
[[nodiscard]] std::string material_asset(MjcfWriter& writer, const Geom& geom);

/// The joints that a body has in MJCF in the place of a link's one: three for a planar joint, four for one that floats
/// on something.
struct MjcfStep {
  std::string name;
  JointType type{};
  Transform<double> X_PF = Transform<double>::identity();  ///< from the last step's frame
  Vec3<double> axis{0, 0, 1};
  double reference = 0;
  const Joint* joint = nullptr;
  double spring_reference = 0;  ///< where the joint's spring is at rest
};

/// Joints in turn that move one body: where the file places it, and each joint in it.
struct MjcfChain {
  std::vector<MjcfStep> steps;
  Vec3<double> to_body{};  ///< the body's origin in the last step's frame
  Transform<double> X_PB = Transform<double>::identity();
  Quat<double> quat = Quat<double>::identity();  ///< of X_PB, as it is written
  std::vector<Vec3<double>> anchors, axes;       ///< in the body's frame
};

/// Finds X_PB, anchors and axes such that the reader finds the steps; false if it does so up to rounding only, the
/// frames between the steps being turned.
bool place_chain(MjcfChain& chain);
void write_joint(MjcfWriter& writer, pugi::xml_node body, const MjcfChain& chain, std::size_t step);

}  // namespace manyhands::io
