// One world in double precision, for scripting and tests: parts with names, a state, what drives it, and its clock.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string_view>

#include "manyhands/model/couplings.h"
#include "manyhands/model/load_report.h"
#include "manyhands/physics/dynamics/measures.h"
#include "manyhands/physics/world/contact_report.h"

namespace manyhands {

struct Body;
struct Sensor;  // sensor.h
class Model;
struct LinkDistance;    // queries.h
struct SolverSettings;  // contact_solver.h
struct WorldCore;
struct WorldRayHit;  // queries.h

enum class Integrator {
  kSemiImplicit,  ///< first order, implicit damping, motors, limits and contacts
  kRungeKutta4,   ///< fourth order, without motors, limits and contacts
};

/// Motor commands, one number per dof (nv) each; see `World::set_motors`.
struct MotorCommands {
  std::span<const double> target_q;  ///< [rad or m]; read for dofs with one coordinate, not for rotations by quaternion
  std::span<const double> target_v;  ///< [rad/s or m/s]
  std::span<const double> kp;        ///< share of the position error that one step removes
  std::span<const double> kd;        ///< share of the velocity error that one step removes
  std::span<const double> max_force;  ///< [N m or N]; 0 switches the motor off
};

/// The motor of one joint with one degree of freedom: as MotorCommands, which has the units.
struct JointMotor {
  double target_q = 0, target_v = 0, kp = 0, kd = 1, max_force = 0;
};

/// A step led to numbers that are not finite, or made motion from nothing (energy_balance.h); the world is as it was
/// before that step.
class SimulationError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A body to add: one shape.
struct NewBody {
  std::string name{};
  Shape shape{};
  Mesh mesh{};      ///< of ShapeType::kConvex and kMesh
  double mass = 1;  ///< [kg], spread evenly over the shape; not read where `fixed`
  Transform<double> X_WB = Transform<double>::identity();
  SurfaceMaterial surface{};
  std::array<float, 4> rgba{0.7f, 0.7f, 0.7f, 1.0f};
  bool fixed = false;  ///< welded to the world; planes and triangle meshes must be
};

/// Where a joint with one degree of freedom is to go.
struct JointTarget {
  std::string joint{};
  double q = 0;  ///< [rad or m]
};

/// What `World::diagnose` noticed.
struct Finding {
  std::string kind;  ///< "no_step", "gravity", "no_shape", "no_ground", "weak_motor", "target_beyond_limit"
  std::vector<std::string> parts;  ///< links or joints
  std::string text;                ///< a sentence that says what to do
};

/// A model in motion. Arrays are copied in and out; setters throw std::invalid_argument if a length is not what the
/// model asks for, a number is not finite, or a quaternion not of unit length (to 1e-5; it is normalised). Names that
/// are not there throw std::out_of_range. Not to be shared by threads, its const members included.
class World {
 public:
  /// Without parts; gravity is (0, 0, -9.81).
  explicit World(double time_step = 0.002, Integrator integrator = Integrator::kSemiImplicit);
  /// Starts at rest in the model's initial configuration, with motors off. Throws std::invalid_argument unless
  /// time_step > 0.
  explicit World(std::shared_ptr<const Model> model, double time_step = 0.002,
                 Integrator integrator = Integrator::kSemiImplicit);
  World(const World& other);
  World(World&& other) noexcept;
  World& operator=(World other) noexcept;
  ~World();
  /// Loads a URDF file, base fixed, an MJCF file or an SDF file, told by its root element, and keeps its report. Of an
  /// SDF file with several models, parts are called "MODEL/part". Without time_step: the file's, or 0.002 s.
  /// `allow_outside_package` and `compliance` are the loaders'. Throws what the loaders throw.
  [[nodiscard]] static World from_file(const std::filesystem::path& path, std::optional<double> time_step = {},
                                       Integrator integrator = Integrator::kSemiImplicit,
                                       bool allow_outside_package = false,
                                       MjcfCompliance compliance = MjcfCompliance::kStated);

  /// Advances by n steps. Throws SimulationError, which names joints, time and cause, if a step leads to numbers that
  /// are not finite, or moves things so far that it makes motion from nothing. With kRungeKutta4 throws
  /// std::runtime_error if a motor is on, something touches, or a joint with limits lies outside them: this integrator
  /// would ignore these. The state stays as it was before that step; forces of `apply_force` are gone.
  void step(int n = 1);

  [[nodiscard]] const Model& model() const;
  [[nodiscard]] std::shared_ptr<const Model> shared_model() const;
  [[nodiscard]] const LoadReport& report() const { return report_; }  ///< of `from_file` and files added since
  [[nodiscard]] double time_step() const { return time_step_; }
  [[nodiscard]] Integrator integrator() const { return integrator_; }
  [[nodiscard]] double time() const { return since_ + static_cast<double>(steps_) * time_step_; }  ///< [s]
  /// The length of the steps to come. Throws std::invalid_argument unless it is above 0.
  void set_time_step(double time_step);

  // ---- state (world.cpp) ---------------------------------------------------------------------------------------
  [[nodiscard]] std::span<const double> q() const;     ///< (nq)
  [[nodiscard]] std::span<const double> v() const;     ///< (nv)
  [[nodiscard]] std::span<const double> tau() const;   ///< (nv) [N m or N]
  [[nodiscard]] std::span<const double> ctrl() const;  ///< (nu)
  [[nodiscard]] std::span<const double> act() const;   ///< (na) of the actuators that have an activation, in order
  void set_q(std::span<const double> q);
  void set_v(std::span<const double> v);
  void set_tau(std::span<const double> tau);  ///< acts in every step until it is set again
  /// Commands of the actuators, see ActuatorType; each is kept within its actuator's range.
  void set_ctrl(std::span<const double> ctrl);
  void set_act(std::span<const double> act);  ///< each step keeps them within their bounds
  /// Of the actuator of that name. Throws std::invalid_argument if it has none.
  [[nodiscard]] double activation(std::string_view actuator) const;
  void set_activation(std::string_view actuator, double act);
  /// q, v, ctrl, act and the poses of mocap bodies as the model's keyframe has them. Throws std::out_of_range where
  /// there is none of that name; a world loses its model's keyframes when parts come or go.
  void set_keyframe(std::string_view name);

  /// Motors at the velocity level, as PyBullet's: per step a dof is driven towards the velocity
  /// kp (target_q - q) / h + v' + kd (target_v - v') with at most max_force, where v' is what it would reach without.
  /// Throws std::invalid_argument where a position or velocity actuator drives the dof already.
  void set_motors(const MotorCommands& commands);

  /// Sets the motors of some joints as `set_motors` does and leaves the others alone: target_q is each one's q,
  /// target_v 0. max_force [N m or N] is each joint's effort unless it is given. Throws std::out_of_range for a name
  /// that is not there, std::invalid_argument for a joint without exactly one degree of freedom, one whose effort
  /// nobody gave, a target beyond its limits, and numbers that are not finite; then no motor has changed.
  void move(std::span<const JointTarget> targets, double kp = 0.1, double kd = 1,
            std::optional<double> max_force = {});  // world_motion.cpp

  [[nodiscard]] std::vector<double> tendon_lengths() const;     ///< in the order of Model::tendons [m, or as q]
  [[nodiscard]] std::vector<double> tendon_velocities() const;  ///< their rates

  [[nodiscard]] Energy<double> energy() const;                   ///< [J]
  [[nodiscard]] MassProperties<double> mass_properties() const;  ///< centre of mass, momentum about the world's origin

  /// All that a run continues from, bit for bit, as bytes (see snapshot.h): state, contact cache, commands, forces
  /// applied, parameters and clock; not the solver's settings.
  [[nodiscard]] std::vector<std::uint8_t> snapshot() const;
  /// Throws std::invalid_argument if the snapshot is not of a world with this model and time step, or holds numbers
  /// that cannot be; then nothing has changed. What the last step found (contacts, reactions) is forgotten.
  void restore(std::span<const std::uint8_t> snapshot);
  /// The whole world for another process of the same build: its model, report, settings of the solver and snapshot.
  [[nodiscard]] std::vector<std::uint8_t> archived() const;
  /// A world that goes on with the same bits. Throws std::invalid_argument on damaged bytes.
  [[nodiscard]] static World unarchived(std::span<const std::uint8_t> bytes);
  /// Starts the clock anew and forgets the solver's warm start: what follows depends on q, v, act, forces and
  /// commands alone.
  void forget();
  /// FNV-1a over the bits of what a snapshot holds.
  [[nodiscard]] std::uint64_t state_hash() const;

  // ---- bodies by name: links and frames (world_bodies.cpp) -----------------------------------------------------
  [[nodiscard]] Transform<double> body_pose(std::string_view name) const;   ///< X_WL
  [[nodiscard]] Motion<double> body_velocity(std::string_view name) const;  ///< of its origin, world axes
  /// Puts a free body somewhere, or a link that is welded to the world. Throws std::invalid_argument for other links.
  void set_body_pose(std::string_view name, const Transform<double>& X_WL);
  /// Of a free body: of the link's origin, in world axes. Throws std::invalid_argument for other links.
  void set_body_velocity(std::string_view name, const Motion<double>& V_WL);
  /// Puts a body that a mocap joint carries at X_WL, at rest. It pushes what touches it, and pulls what is welded to
  /// it. Throws std::invalid_argument for other links.
  void set_mocap(std::string_view link, const Transform<double>& X_WL);
  /// Poses of the model's mocap bodies, in its order: x y z [m] and quaternion xyzw each.
  [[nodiscard]] std::span<const double> mocap() const;
  /// A force [N] at `point` (world, default: the link's centre of mass) and a torque [N m], in world axes; acts in the
  /// next step only. Forces add up.
  void apply_force(std::string_view name, const Vec3<double>& force, const Vec3<double>& torque = Vec3<double>::zero(),
                   const std::optional<Vec3<double>>& point = {});

  // ---- the same by ids (world_ids.cpp), for programs that ask often ----------------------------------------------
  /// The parts that ids count: the model, with what was removed still in it. Parts that come or go leave the others
  /// their ids, until `edition` grows.
  [[nodiscard]] const Model& parts() const;
  [[nodiscard]] std::int64_t edition() const { return edition_; }
  [[nodiscard]] Transform<double> link_pose(LinkId link) const;     ///< X_WL
  [[nodiscard]] Motion<double> link_velocity(LinkId link) const;    ///< of its origin, world axes
  void set_link_pose(LinkId link, const Transform<double>& X_WL);   ///< as set_body_pose, and of mocap bodies
  void set_link_velocity(LinkId link, const Motion<double>& V_WL);  ///< as set_body_velocity
  void apply_link_force(LinkId link, const Vec3<double>& force, const Vec3<double>& torque,
                        const Vec3<double>& point);                    ///< as apply_force
  [[nodiscard]] std::span<const double> joint_q(JointId joint) const;  ///< its part of q
  [[nodiscard]] std::span<const double> joint_v(JointId joint) const;  ///< its part of v
  /// Puts a joint where it is told to be. Throws std::invalid_argument on wrong lengths and numbers that are not
  /// finite.
  void set_joint(JointId joint, std::span<const double> q, std::span<const double> v);
  /// Its part of tau, which acts in every step until it is set again.
  void set_joint_tau(JointId joint, std::span<const double> tau);
  /// Of each dof of the joint. Throws std::invalid_argument on numbers that are not finite, or negative where they may
  /// not be.
  void set_joint_motor(JointId joint, const JointMotor& motor);
  void set_joint_motors(JointId joint, std::span<const JointMotor> motors);  ///< one for each dof
  /// What motor and limits did to the joint's dofs in the last step, their mean force over it [N m or N]; 0 before one.
  [[nodiscard]] std::vector<double> joint_forces(JointId joint) const;
  void set_joint_damping(JointId joint, double damping);
  /// Throws std::invalid_argument unless lower <= upper, and for a joint that was made without limits.
  void set_joint_limits(JointId joint, double lower, double upper);
  /// Gives a link that moves other mass properties. Throws std::invalid_argument unless the mass is above 0.
  void set_link_inertial(LinkId link, const Inertial& inertial);
  /// Between the surfaces of two links, as `distance`.
  [[nodiscard]] std::optional<LinkDistance> link_distance(LinkId link_a, LinkId link_b) const;
  /// Whether geoms of two links may touch, as `set_collision`.
  void set_link_collision(LinkId link_a, LinkId link_b, bool enabled);
  /// Adds an equality constraint between links or joints of `parts`. Throws ModelError where ModelBuilder does.
  void add_equality(const EqualityConstraint& equality);
  /// Gives a constraint of that name and type other frames, ratio, offset or largest force. Throws std::out_of_range.
  void set_equality(const EqualityConstraint& equality);
  /// The same for the steps to come alone: the model does not change.
  void aim_equality(const EqualityConstraint& equality);
  void remove_equality(std::string_view name);
  void set_link_surface(LinkId link, const SurfaceMaterial& surface);  ///< of its colliding geoms; friction_y not read

  // ---- what the last step found (world_contacts.cpp); empty or 0 before a step, after `restore` and other parts ----
  [[nodiscard]] std::vector<Contact> contacts() const;
  /// What contacts do to the link; only those with `other`, if it is named.
  [[nodiscard]] ContactWrench contact_wrench(std::string_view link, std::string_view other = {}) const;
  /// What the joint transmits to its child link, its motor's effort included: force and torque about the child's origin
  /// as it was before the last step, in world axes. Fixed joints have one too. Throws std::runtime_error before a step,
  /// with kRungeKutta4, or for a joint inside a closed loop.
  [[nodiscard]] Force<double> joint_wrench(std::string_view joint) const;
  [[nodiscard]] ContactResiduals residuals() const;
  [[nodiscard]] double max_penetration() const;  ///< deepest contact before the last step [m]; 0 if none
  [[nodiscard]] int solver_iterations() const;
  [[nodiscard]] const SolverSettings& solver() const;
  /// Throws std::invalid_argument unless max_iterations is 1 or more and the tolerance 0 or more.
  void set_solver(const SolverSettings& settings);

  // ---- sensors of the model (world_sensors.cpp) -----------------------------------------------------------------
  /// The numbers of the sensor of that name, see SensorType: of the present state, or what the last step found. Where
  /// there was none in this world, what the next step would find, taken on a copy. Throws std::runtime_error with
  /// kRungeKutta4, which finds none.
  [[nodiscard]] std::vector<double> sensor(std::string_view name) const;
  /// Of all sensors, one after the other in the order of Model::sensors.
  [[nodiscard]] std::vector<double> sensor_data() const;

  // ---- where geoms are in the present state (world_queries.cpp) -------------------------------------------------
  /// Between the surfaces of two links, whether or not they may touch; none if one of them has no colliding geom.
  /// Throws std::invalid_argument for one link twice.
  [[nodiscard]] std::optional<LinkDistance> distance(std::string_view link_a, std::string_view link_b) const;
  /// Every two links that may touch and are less than d [m] apart.
  [[nodiscard]] std::vector<LinkDistance> near_links(double d) const;
  /// The same, but only those with `link`: a fraction of the work.
  [[nodiscard]] std::vector<LinkDistance> near_links(double d, std::string_view link) const;
  /// The first colliding geom on each ray from origins[i] along directions[i], no farther than max_distance [m]. World
  /// axes; directions have any length above 0. Throws std::invalid_argument otherwise, or if the spans differ in
  /// length.
  [[nodiscard]] std::vector<std::optional<WorldRayHit>> ray_cast(std::span<const Vec3<double>> origins,
                                                                 std::span<const Vec3<double>> directions,
                                                                 double max_distance) const;
  /// All that one ray meets, the nearest first, each geom where the ray enters it: at distance 0 if it begins inside.
  [[nodiscard]] std::vector<WorldRayHit> ray_cast_all(const Vec3<double>& origin, const Vec3<double>& direction,
                                                      double max_distance) const;

  /// Of a link or geom of a query's result. The id is that of `model`; these do not ask for it, since that clears out
  /// what was removed.
  [[nodiscard]] std::string link_name(LinkId id) const;
  [[nodiscard]] std::string geom_name(GeomId id) const;  ///< or "link#k" for the k-th nameless geom of a link

  /// What commonly goes wrong, if it does here: that no step was taken, that gravity is zero; free bodies without a
  /// shape, or that fall with nothing below; motors that give all they may and still cannot hold their joint, or are to
  /// go beyond its limits. Costs a pass over the world; the world does not change.
  [[nodiscard]] std::vector<Finding> diagnose() const;  // world_diagnosis.cpp

  // ---- parts (world_edit.cpp): a change costs what it touches, not what is there --------------------------------
  /// Adds a model at X_WM. With a name, its parts are called "name/part". Throws ModelError if a name is taken.
  void add(const Model& model, const Transform<double>& X_WM = Transform<double>::identity(),
           const std::string& name = {});
  /// The same from a URDF, MJCF or SDF file.
  void add_file(const std::filesystem::path& path, const Transform<double>& X_WM = Transform<double>::identity(),
                const std::string& name = {}, bool allow_outside_package = false);
  /// Adds one body. Throws ModelError or std::invalid_argument on a taken name, a mass or size that is not above 0.
  void add_body(const NewBody& body);
  /// Holds two links as they are to each other now, until `unweld`. An empty link_b is the world. Returns the weld's
  /// name. Throws std::out_of_range for a link that is not there, std::invalid_argument for one link twice or a weld
  /// that there is.
  std::string weld(std::string_view link_a, std::string_view link_b = {});  // world_motion.cpp
  /// Ends a weld. Throws std::out_of_range if there is none of that name.
  void unweld(std::string_view name);
  /// Removes what was added by that name, or the link and all that hangs on it. Throws std::out_of_range.
  void remove(const std::string& name);
  /// What `remove` takes as a whole: names of models and of links on the world.
  [[nodiscard]] std::vector<std::string> names() const;
  /// Whether geoms of two links may touch, or of all links of two models that were added by name. Joint neighbours,
  /// filters and links of one body have their say besides. Throws std::out_of_range.
  void set_collision(const std::string& a, const std::string& b, bool enabled);

  // ---- parameters of this world (world_params.cpp); the model keeps its own --------------------------------------
  [[nodiscard]] Vec3<double> gravity() const;
  void set_gravity(const Vec3<double>& gravity);
  [[nodiscard]] double mass(std::string_view link) const;  ///< [kg]
  void set_mass(std::string_view link, double mass);       ///< scales the inertia with it
  /// Of a geom, or of all colliding geoms of a link.
  [[nodiscard]] double friction(std::string_view name) const;
  void set_friction(std::string_view name, double friction);
  void set_spinning_friction(std::string_view name, double spinning);  ///< [m]
  void set_rolling_friction(std::string_view name, double rolling);    ///< [m]
  [[nodiscard]] double restitution(std::string_view name) const;
  void set_restitution(std::string_view name, double restitution);
  [[nodiscard]] double damping(std::string_view joint) const;  ///< [N m s/rad or N s/m]
  void set_damping(std::string_view joint, double damping);
  [[nodiscard]] double stiffness(std::string_view joint) const;  ///< of its spring [N m/rad or N/m]
  void set_stiffness(std::string_view joint, double stiffness);
  void set_joint_friction(std::string_view joint, double friction);   ///< dry [N m or N]
  void set_armature(std::string_view joint, double armature);         ///< [kg m^2 or kg]
  [[nodiscard]] Vec3<double> geom_size(std::string_view geom) const;  ///< see Shape [m]
  void set_geom_size(std::string_view geom, const Vec3<double>& size);
  [[nodiscard]] std::pair<double, double> gains(std::string_view actuator) const;  ///< kp, kd, see Actuator
  void set_gains(std::string_view actuator, double kp, double kd);

 private:
  struct Shown;

  /// As it is, and without the parts that were removed.
  [[nodiscard]] WorldCore& core() const;
  /// Where parts that were removed may still lie; names find the others only.
  [[nodiscard]] WorldCore& loose() const;
  void rebuild() const;
  void step_once(WorldCore& core);
  void require_balance(WorldCore& core);
  [[noreturn]] void fail_step(WorldCore& core, const std::string& what);
  void runge_kutta_step_or_throw(WorldCore& core);
  void require_apart(WorldCore& core) const;
  /// What a link and all that hangs on it got from what it hangs on in the last step, about the world's origin.
  [[nodiscard]] Force<double> wrench_into(const WorldCore& core, LinkId link) const;
  [[nodiscard]] std::vector<double> read_sensors(std::span<const Sensor> sensors) const;
  void read_last_step(std::span<const Sensor> sensors, std::vector<std::vector<double>>& readings) const;
  void require_within_limits(const WorldCore& core, const char* when) const;
  [[nodiscard]] const Body& free_body(const WorldCore& core, const Link& link, const char* what) const;
  [[nodiscard]] static const Link& required_link(const WorldCore& core, LinkId link);
  [[nodiscard]] static const Body& required_body(const WorldCore& core, JointId joint);

  double time_step_;
  Integrator integrator_;
  double since_ = 0;        // time before the last change of the time step
  std::int64_t steps_ = 0;  // since then
  mutable std::int64_t edition_ = 0;
  LoadReport report_;
  std::unique_ptr<SolverSettings> solver_;
  mutable std::unique_ptr<WorldCore> core_;
  std::unique_ptr<Shown> shown_;
};

}  // namespace manyhands
