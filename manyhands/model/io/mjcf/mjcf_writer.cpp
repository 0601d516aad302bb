#include "manyhands/model/io/mjcf/mjcf_writer.h"

#include "manyhands/model/io/text_numbers.h"

namespace manyhands {

namespace io {

MjcfWriter::MjcfWriter(const Model& described, SaveNotes& save_notes, AssetFiles* asset_files)
    : model(described),
      notes(save_notes),
      files(asset_files),
      root(document.append_child("mujoco")),
      carried_by(described.links().size()),
      geom_names(described.geoms().size()),
      frames_of(described.links().size()) {
  for (std::size_t i = described.links().size(); i < described.frames().size(); ++i) {
    const Frame& frame = described.frames()[i];
    if (!frame.name.empty()) frames_of[frame.link.index()].push_back(static_cast<int>(i));
  }
}

std::array<double, 4> wxyz(const Quat<double>& q) { return {q.w, q.x, q.y, q.z}; }

void write_pose(pugi::xml_node node, const Vec3<double>& p, const Quat<double>& q) {
  if (!same(p, Vec3<double>::zero())) set(node, "pos", p);
  if (q.w != 1) set(node, "quat", wxyz(q));
}

void write_pose(pugi::xml_node node, const Transform<double>& X) { write_pose(node, X.p, quat_for(X.R)); }

namespace {

template <class Lies>
std::string find_or_add_site(MjcfWriter& writer, LinkId link, const Transform<double>& X, const std::string& wanted,
                             Lies lies) {
  for (const int i : writer.frames_of[link.index()]) {
    const Frame& frame = writer.model.frames()[static_cast<std::size_t>(i)];
    if (lies(frame.X_LF)) return frame.name;
  }
  const std::string name = writer.names.claim("site", wanted, "site", writer.notes);
  pugi::xml_node body = writer.place_of(link).node;
  pugi::xml_node site = body.append_child("site");
  set(site, "name", name);
  write_pose(site, X);
  return name;
}

}  // namespace

std::string site_at(MjcfWriter& writer, LinkId link, const Transform<double>& X, const std::string& wanted) {
  return find_or_add_site(writer, link, X, wanted,
                          [&](const Transform<double>& X_LF) { return same(X_LF.p, X.p) && same(X_LF.R, X.R); });
}

std::string site_at(MjcfWriter& writer, LinkId link, const Vec3<double>& p, const std::string& wanted) {
  return find_or_add_site(writer, link, {Mat3<double>::identity(), p}, wanted,
                          [&](const Transform<double>& X_LF) { return same(X_LF.p, p); });
}

void write_settings(MjcfWriter& writer) {
  const Model& model = writer.model;
  require_text(model.name());
  set(writer.root, "model", model.name());
  pugi::xml_node compiler = writer.root.append_child("compiler");
  set(compiler, "angle", "radian");
  set(compiler, "autolimits", "true");
  set(compiler, "inertiafromgeom", "false");
  pugi::xml_node option = writer.root.append_child("option");
  set(option, "gravity", model.gravity());
  set_unless(option, "density", model.medium().density, 0);
  set_unless(option, "viscosity", model.medium().viscosity, 0);
  if (model.medium().drags()) set(option, "wind", model.medium().wind);
  if (model.time_step()) {
    set(option, "timestep", *model.time_step());
  } else {
    writer.notes.changed("model " + in_quotes(model.name()), "it asks for no time step; readers take MJCF's, 0.002 s");
  }
  if (!model.contact_rules().contacts) set(option.append_child("flag"), "contact", "disable");
  writer.assets = writer.root.append_child("asset");
  writer.world = writer.root.append_child("worldbody");
}

namespace {

SavedText saved(const Model& model, const std::string& file, AssetFiles* files, const SaveOptions& options) {
  SaveNotes notes(file, "MJCF");
  MjcfWriter writer(model, notes, files);
  write_settings(writer);
  choose_filters(writer);
  write_world(writer);
  write_contacts(writer);
  write_tendons(writer);
  write_equalities(writer);
  write_actuators(writer);
  write_sensors(writer);
  write_keyframes(writer);
  return {text_of(writer.document), notes.take(options)};
}

}  // namespace

}  // namespace io

LoadReport save_mjcf(const Model& model, const std::filesystem::path& path, const SaveOptions& options) {
  return io::save_with_assets(path,
                              [&](io::AssetFiles& files) { return io::saved(model, path.string(), &files, options); });
}

SavedText save_mjcf_string(const Model& model, const SaveOptions& options) {
  return io::saved(model, "mjcf", nullptr, options);
}

}  // namespace manyhands
