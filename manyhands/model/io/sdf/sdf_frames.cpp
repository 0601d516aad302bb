#include "manyhands/model/io/sdf/sdf_frames.h"

#include <vector>

#include "manyhands/model/io/text_numbers.h"

namespace manyhands::io {

void SdfFrames::add(const std::string& key, SdfFrame frame) {
  const SdfElement source = frame.source;
  const auto [entry, is_new] = frames_.emplace(key, std::move(frame));
  if (!is_new) {
    source.fail("the name is taken by line " + std::to_string(entry->second.source.line()) + "; expected another name");
  }
}

std::string SdfFrames::find(const SdfElement& source, const std::string& scope, const std::string& name) const {
  if (scope.empty() && name == "world") return "";
  for (const std::string& key : {scope + name, scope + name + "::__model__"}) {
    if (frames_.contains(key)) return key;
  }
  source.fail(in_quotes(name) + " is no link, joint, frame or model here; expected the name of one");
}

bool SdfFrames::is_world(const std::string& scope, const std::string& name) const {
  return name == "world" && !frames_.contains(scope + name);
}

std::string SdfFrames::base_of(const SdfFrame& frame) const {
  return frame.pose.relative_to.empty() ? frame.base : find(frame.source, frame.scope, frame.pose.relative_to);
}

Transform<double> SdfFrames::local(const std::string& key, const SdfFrame& frame, int depth) const {
  if (frame.placement.empty()) return frame.pose.X;
  const std::string inner = key.substr(0, key.size() - std::string_view("__model__").size());
  return frame.pose.X * inverse(pose_in(key, find(frame.source, inner, frame.placement), depth + 1));
}

Transform<double> SdfFrames::pose_in(const std::string& model, const std::string& key, int depth) const {
  constexpr int kMostDepth = 32;
  Transform<double> X = Transform<double>::identity();
  std::string at = key;
  for (std::size_t steps = 0; at != model; ++steps) {
    const SdfElement& source = frames_.at(model).source;
    if (at.empty() || steps > frames_.size() || depth > kMostDepth) {
      source.fail("its placement frame is not placed within the model; expected one that is");
    }
    const SdfFrame& frame = frames_.at(at);
    X = local(at, frame, depth) * X;
    at = base_of(frame);
  }
  return X;
}

Transform<double> SdfFrames::pose(const std::string& key) const {
  std::vector<std::string> chain;  // up to one whose pose is known
  std::string at = key;
  while (!at.empty() && !found_.contains(at)) {
    const SdfFrame& frame = frames_.at(at);
    if (chain.size() > frames_.size()) frame.source.fail("its pose is, through others, relative to itself");
    chain.push_back(at);
    at = base_of(frame);
  }
  Transform<double> X = at.empty() ? Transform<double>::identity() : found_.at(at);
  for (; !chain.empty(); chain.pop_back()) {
    X = X * local(chain.back(), frames_.at(chain.back()), 0);
    found_.emplace(chain.back(), X);
  }
  return X;
}

std::string SdfFrames::link_of(const std::string& key) const {
  std::string at = key;
  for (std::size_t steps = 0; !at.empty(); ++steps) {
    const SdfFrame& frame = frames_.at(at);
    if (frame.attached_to.empty()) break;
    if (steps > frames_.size()) frame.source.fail("it is, through others, attached to itself; expected a link");
    if (is_world(frame.attached_scope, frame.attached_to)) return "";
    at = find(frame.source, frame.attached_scope, frame.attached_to);
  }
  return at;
}

}  // namespace manyhands::io
