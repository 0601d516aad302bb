#include "manyhands/model/io/urdf/urdf_tree.h"

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "manyhands/base/assert.h"
#include "manyhands/model/io/text_numbers.h"

namespace manyhands::io {

namespace {

constexpr std::size_t kNone = static_cast<std::size_t>(-1);

using Indices = std::map<std::string, std::size_t, std::less<>>;

std::size_t find_link(const Indices& links, const UrdfJoint& joint, const char* end, const std::string& name) {
  const auto found = links.find(name);
  if (found == links.end()) {
    joint.source.fail("its " + std::string(end) + " " + in_quotes(name) + " is no link; expected the name of a <link>");
  }
  return found->second;
}

/// The joint to each link's parent, or kNone.
std::vector<std::size_t> find_parents(const UrdfRobot& robot, const Indices& links) {
  std::vector<std::size_t> parent_joint(robot.links.size(), kNone);
  for (std::size_t j = 0; j < robot.joints.size(); ++j) {
    const UrdfJoint& joint = robot.joints[j];
    const std::size_t parent = find_link(links, joint, "parent", joint.parent);
    const std::size_t child = find_link(links, joint, "child", joint.child);
    if (parent == child)
      joint.source.fail("parent and child are both " + in_quotes(joint.child) + "; expected two links");
    if (parent_joint[child] != kNone) {
      const UrdfJoint& other = robot.joints[parent_joint[child]];
      joint.source.fail("its child " + in_quotes(joint.child) + " is the child of joint " +
                        in_quotes(other.joint.name) + " (line " + std::to_string(other.source.line()) +
                        ") already; expected one parent");
    }
    parent_joint[child] = j;
  }
  return parent_joint;
}

std::size_t find_root(const UrdfRobot& robot, const std::vector<std::size_t>& parent_joint) {
  const auto root = static_cast<std::size_t>(std::ranges::find(parent_joint, kNone) - parent_joint.begin());
  if (root == robot.links.size()) {
    robot.links.front().source.fail(
        "every link is the child of another: the joints form a cycle; expected one root link");
  }
  const auto after = parent_joint.begin() + static_cast<std::ptrdiff_t>(root) + 1;
  const auto second = static_cast<std::size_t>(std::find(after, parent_joint.end(), kNone) - parent_joint.begin());
  if (second != robot.links.size()) {
    const UrdfLink& first = robot.links[root];
    robot.links[second].source.fail("a second root: neither this link nor " + in_quotes(first.name) + " (line " +
                                    std::to_string(first.source.line()) +
                                    ") is the child of a joint; expected one root link");
  }
  return root;
}

void check_mimics(const UrdfRobot& robot) {
  Indices joints;
  for (std::size_t j = 0; j < robot.joints.size(); ++j) joints.emplace(robot.joints[j].joint.name, j);
  std::vector<std::size_t> driver(robot.joints.size(), kNone);
  for (std::size_t j = 0; j < robot.joints.size(); ++j) {
    const UrdfJoint& joint = robot.joints[j];
    if (!joint.joint.mimic) continue;
    const auto found = joints.find(joint.joint.mimic->joint);
    MANYHANDS_ASSERT(found != joints.end());  // `read_robot` drops the others
    if (velocity_size(robot.joints[found->second].joint.type) != 1) {
      joint.source.fail("it mimics " + in_quotes(found->first) + ", which is " +
                        to_string(robot.joints[found->second].joint.type) + "; expected a joint with one coordinate");
    }
    driver[j] = found->second;
  }
  // Each joint has at most one driver, so a walk that started in a circle comes back within so many steps.
  std::vector<int> walked_by(driver.size(), -1);
  for (std::size_t start = 0; start < driver.size(); ++start) {
    for (std::size_t j = start; j != kNone && walked_by[j] != static_cast<int>(start); j = driver[j]) {
      if (walked_by[j] >= 0) break;
      walked_by[j] = static_cast<int>(start);
      if (driver[j] != kNone && walked_by[driver[j]] == static_cast<int>(start)) {
        robot.joints[j].source.fail(
            "it mimics, directly or through others, itself; expected a joint that moves freely");
      }
    }
  }
}

}  // namespace

std::vector<std::size_t> UrdfTree::depth_first() const {
  std::vector<std::size_t> order{root};
  for (const UrdfBranch& branch : branches) order.push_back(branch.link);
  return order;
}

UrdfTree find_tree(const UrdfRobot& robot) {
  Indices links;
  for (std::size_t i = 0; i < robot.links.size(); ++i) links.emplace(robot.links[i].name, i);
  const std::vector<std::size_t> parent_joint = find_parents(robot, links);
  check_mimics(robot);
  UrdfTree tree{.root = find_root(robot, parent_joint), .branches = {}};

  std::vector<std::vector<UrdfBranch>> branches(robot.links.size());
  for (std::size_t j = 0; j < robot.joints.size(); ++j) {
    branches[links.at(robot.joints[j].parent)].push_back(
        {j, links.at(robot.joints[j].child), links.at(robot.joints[j].parent)});
  }
  std::vector<UrdfBranch> stack(branches[tree.root].rbegin(), branches[tree.root].rend());
  while (!stack.empty()) {
    const UrdfBranch branch = stack.back();
    stack.pop_back();
    tree.branches.push_back(branch);
    stack.insert(stack.end(), branches[branch.link].rbegin(), branches[branch.link].rend());
  }
  if (tree.branches.size() + 1 < robot.links.size()) {
    std::vector<bool> reached(robot.links.size(), false);
    for (const std::size_t link : tree.depth_first()) reached[link] = true;
    const auto lost = static_cast<std::size_t>(std::ranges::find(reached, false) - reached.begin());
    robot.links[lost].source.fail("it is its own ancestor: the joints form a cycle; expected a tree");
  }
  return tree;
}

UrdfTree in_file_order(UrdfTree tree) {
  std::vector<UrdfBranch> waiting = std::exchange(tree.branches, {});
  std::ranges::stable_sort(waiting, {}, &UrdfBranch::link);
  std::set<std::size_t> there{tree.root};
  while (!waiting.empty()) {
    const auto next =
        std::ranges::find_if(waiting, [&](const UrdfBranch& branch) { return there.contains(branch.parent); });
    there.insert(next->link);
    tree.branches.push_back(*next);
    waiting.erase(next);
  }
  return tree;
}

}  // namespace manyhands::io
