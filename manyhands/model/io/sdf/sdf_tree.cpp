#include "manyhands/model/io/sdf/sdf_tree.h"

#include <algorithm>
#include <map>

#include "manyhands/model/io/text_numbers.h"

namespace manyhands::io {

namespace {

/// The index of the link with that key; kNone for the world.
std::size_t index_of(const std::map<std::string, std::size_t>& links, const SdfJoint& joint, const std::string& key) {
  if (key.empty()) return kNone;
  const auto found = links.find(key);
  if (found == links.end()) joint.source.fail(in_quotes(key) + " is a link of another model; expected one of this");
  return found->second;
}

}  // namespace

std::string parent_of(const SdfFrames& frames, const SdfJoint& joint) {
  if (frames.is_world(joint.scope, joint.parent)) return "";
  return frames.link_of(frames.find(joint.source, joint.scope, joint.parent));
}

SdfTree find_tree(const SdfFrames& frames, const SdfModel& model) {
  SdfTree tree;
  std::map<std::string, std::size_t> links;
  for (std::size_t i = 0; i < model.links.size(); ++i) links.emplace(model.links[i].key, i);
  std::vector<bool> is_held(model.links.size(), false);
  std::vector<std::vector<SdfBranch>> branches(model.links.size() + 1);  // those of the world last
  for (std::size_t j = 0; j < model.joints.size(); ++j) {
    const SdfJoint& joint = model.joints[j];
    if (frames.is_world(joint.scope, joint.child)) joint.source.fail("its child is the world; expected a link");
    const std::string parent = parent_of(frames, joint);
    const std::string child = frames.link_of(frames.find(joint.source, joint.scope, joint.child));
    const std::size_t from = index_of(links, joint, parent), to = index_of(links, joint, child);
    if (from == to || to == kNone) joint.source.fail("parent and child are one link; expected two");
    if (is_held[to]) {
      tree.loops.push_back({j, parent, child});
      continue;
    }
    is_held[to] = true;
    branches[std::min(from, model.links.size())].push_back({to, j});
  }
  std::vector<SdfBranch> stack;
  for (std::size_t i = 0; i < model.links.size(); ++i) {
    if (!is_held[i]) stack.push_back({i, kNone});
  }
  stack.insert(stack.end(), branches.back().begin(), branches.back().end());
  std::ranges::reverse(stack);
  while (!stack.empty()) {
    const SdfBranch branch = stack.back();
    stack.pop_back();
    tree.branches.push_back(branch);
    const std::vector<SdfBranch>& further = branches[branch.link];
    stack.insert(stack.end(), further.rbegin(), further.rend());
  }
  if (tree.branches.size() < model.links.size()) {
    std::vector<bool> reached(model.links.size(), false);
    for (const SdfBranch& branch : tree.branches) reached[branch.link] = true;
    const auto lost = static_cast<std::size_t>(std::ranges::find(reached, false) - reached.begin());
    model.links[lost].source.fail("it is its own ancestor: the joints form a cycle; expected a root");
  }
  return tree;
}

}  // namespace manyhands::io
