#include "manyhands/model/io/missing_inertia.h"

#include <algorithm>
#include <set>

#include "manyhands/model/io/text_numbers.h"

namespace manyhands::io {

namespace {

/// Returns what was done.
std::string give_inertia(ModelBuilder& builder, Joint& joint) {
  constexpr double kMass = 1e-3;            // [kg]
  constexpr double kInertia = 1e-6;         // [kg m^2]
  constexpr double kShareOfLargest = 1e-3;  // of a needle, about its axis: what a thin rod has
  Inertial& inertial = builder.link(joint.child).inertial;
  if (joint.parent == builder.world() && joint.type == JointType::kFloating && joint.child == LinkId(1) &&
      inertial.mass <= 0) {
    joint.type = JointType::kFixed;
    return "the root link has no mass and cannot float; it is fixed to the world";
  }
  std::string given;
  if (inertial.mass < kMass) {
    inertial.mass = kMass;
    given = "a mass of " + format_number(kMass) + " kg and ";
  }
  SymMat3<double>& I = inertial.inertia;
  const double added = std::max(kInertia, kShareOfLargest * std::max({I.xx, I.yy, I.zz}));
  I = I + SymMat3<double>{added, added, added, 0, 0, 0};
  return "joint '" + joint.name + "' would move no inertia; " + given + "an inertia of " + format_number(added) +
         " kg m^2 given to the link";
}

}  // namespace

void give_missing_inertia(ModelBuilder& builder, const std::function<void(const Link&, const std::string&)>& repaired) {
  constexpr int kMostPasses = 8;  // two do, unless numbers are so large that rounding eats what was given
  for (int pass = 0; pass < kMostPasses; ++pass) {
    const std::vector<JointId> found = builder.joints_without_inertia();
    if (found.empty()) return;
    const std::set<JointId> lacking(found.begin(), found.end());
    std::vector<bool> is_served(builder.links().size(), false);  // a link beyond this one was given inertia
    for (std::size_t i = is_served.size() - 1; i > 0; --i) {
      const Link& link = builder.links()[i];
      const bool lacks = lacking.contains(link.joint);
      if (lacks && !is_served[i]) repaired(link, give_inertia(builder, builder.joint(link.joint)));
      if ((lacks || is_served[i]) && link.parent.is_valid()) is_served[link.parent.index()] = true;
    }
  }
}

}  // namespace manyhands::io
