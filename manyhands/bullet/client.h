// One physics client: bodies by numbers, as PyBullet's clients know them, in a World.
#pragma once

#include <array>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "manyhands/bullet/body_plan.h"
#include "manyhands/bullet/concave.h"
#include "manyhands/bullet/records.h"
#include "manyhands/bullet/screen.h"
#include "manyhands/bullet/user_data.h"
#include "manyhands/model/io/loaded_model.h"
#include "manyhands/physics/world/world.h"
#include "manyhands/render/renderer.h"

namespace manyhands::bullet {

/// What PyBullet reports as pybullet.error.
class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

struct Mechanism;    // client_body.h
struct ScreenFrame;  // screen_frame.h

/// A world whose parts have the numbers, frames, motors and defaults of PyBullet. Links are numbered from 0, the base
/// is -1; poses are those of centre-of-mass frames unless a name says otherwise. Getters and setters of what is not
/// there throw Error, or do nothing, as PyBullet's do. Not to be shared by threads.
class Client {
 public:
  Client();
  Client(const Client&) = delete;
  Client& operator=(const Client&) = delete;
  ~Client();

  // ---- stepping (client.cpp) -----------------------------------------------------------------------------------
  void reset();
  void step();
  void set_time_step(double time_step);
  void set_gravity(const Vec3<double>& gravity);
  void detect_collisions();
  [[nodiscard]] const Settings& settings() const { return settings_; }
  Settings& settings() { return settings_; }
  [[nodiscard]] World& world() { return world_; }
  /// What a client with a window shows; null without one.
  [[nodiscard]] Screen* screen() { return screen_.get(); }
  [[nodiscard]] UserData& user_data() { return user_data_; }
  [[nodiscard]] int next_log() { return next_log_++; }
  void open_screen() { screen_ = std::make_unique<Screen>(); }
  /// What makes convex parts of concave meshes that move; without it, or where it finds none, their hulls collide.
  void set_decomposer(Decomposer decompose) { decompose_ = std::move(decompose); }

  // ---- bodies (client_bodies.cpp) ------------------------------------------------------------------------------
  int load_urdf(const std::filesystem::path& path, const Transform<double>& X_WB, const LoadOptions& options);
  std::vector<int> load_mjcf(const std::filesystem::path& path, const LoadOptions& options);
  std::vector<int> load_sdf(const std::filesystem::path& path, const LoadOptions& options);
  int add(BodyPlan plan, const Transform<double>& X_WB);
  void remove(int body);
  [[nodiscard]] std::span<const int> body_ids() const { return order_; }
  [[nodiscard]] bool has_body(int body) const;
  [[nodiscard]] const BodyPlan& plan(int body, const char* error) const;
  [[nodiscard]] int num_joints(int body) const;
  static constexpr const char* kJointRange = "Joint index out-of-range";
  /// Throws Error, which begins with `error` and lists the joints there are.
  void require_joint(int body, int joint, const char* error = kJointRange) const;
  [[nodiscard]] int num_dofs(int body) const;  ///< of its joints; the base has none
  /// Where joint's numbers stand in PyBullet's q (after seven of the base) and v (after six); -1 of fixed joints.
  [[nodiscard]] std::array<int, 2> joint_indices(int body, int joint) const;
  [[nodiscard]] std::vector<std::string> drain_notes();  ///< what loaders had to say since the last call

  // ---- state (client_state.cpp) --------------------------------------------------------------------------------
  [[nodiscard]] Transform<double> base_pose(int body);
  [[nodiscard]] Motion<double> base_velocity(int body);
  void reset_base_pose(int body, const Transform<double>& X_WI);
  void reset_base_velocity(int body, const std::optional<Vec3<double>>& linear,
                           const std::optional<Vec3<double>>& angular);
  [[nodiscard]] JointReading joint_state(int body, int joint);
  void reset_joint(int body, int joint, std::span<const double> q, std::span<const double> v);
  [[nodiscard]] LinkReading link_state(int body, int link);
  void enable_force_torque_sensor(int body, int joint, bool enabled);
  [[nodiscard]] Bounds bounds(int body, int link);
  [[nodiscard]] std::vector<std::array<int, 2>> overlapping(const Bounds& box);

  // ---- motors and forces (client_motors.cpp) -------------------------------------------------------------------
  void set_motor(int body, int joint, const MotorSetting& setting);
  void set_motors(int body, std::span<const int> joints, std::span<const MotorSetting> settings);
  void set_ball_motor(int body, int joint, const BallSetting& setting);  ///< of a spherical joint
  [[nodiscard]] bool is_ball(int body, int joint) const;
  void apply_force(int body, int link, const Vec3<double>& force, const Vec3<double>& point, bool in_link_frame);
  void apply_torque(int body, int link, const Vec3<double>& torque, bool in_link_frame);

  // ---- dynamics (client_dynamics.cpp) --------------------------------------------------------------------------
  void change_dynamics(int body, int link, const DynamicsChange& change);
  [[nodiscard]] DynamicsReading dynamics(int body, int link) const;

  // ---- constraints (client_constraints.cpp) --------------------------------------------------------------------
  int create_constraint(const UserConstraint& constraint);
  void change_constraint(int id, const ConstraintChange& change);
  void remove_constraint(int id);
  [[nodiscard]] const UserConstraint& constraint(int id) const;
  [[nodiscard]] std::span<const int> constraint_ids() const { return constraint_order_; }

  // ---- kinematics (client_kinematics.cpp) ----------------------------------------------------------------------
  [[nodiscard]] std::vector<double> inverse_kinematics(int body, const IkRequest& request);
  /// (6, n) or (6, 6 + n) of a free base: linear rows first, about a point of the link, in the axes of the base.
  [[nodiscard]] std::vector<double> jacobian(int body, int link, const Vec3<double>& point, std::span<const double> q);
  /// Where `padded`, the base of a free body is part of q and comes linear before angular, and its velocities and those
  /// of spherical joints have a last number more, which stands for nothing: v and a are as long as q.
  [[nodiscard]] std::vector<double> mass_matrix(int body, std::span<const double> q, bool padded);
  [[nodiscard]] std::vector<double> inverse_dynamics(int body, std::span<const double> q, std::span<const double> v,
                                                     std::span<const double> a, bool padded);

  // ---- collision (client_collision.cpp) ------------------------------------------------------------------------
  [[nodiscard]] std::vector<ContactReading> contacts(int body_a, int body_b, int link_a, int link_b);
  [[nodiscard]] std::vector<ContactReading> closest_points(int body_a, int body_b, double distance, int link_a,
                                                           int link_b);
  /// `number`: of the link to report, the nearest being 0.
  [[nodiscard]] std::vector<RayReading> cast_rays(std::span<const Vec3<double>> from, std::span<const Vec3<double>> to,
                                                  int mask, int number);
  void set_collision_pair(int body_a, int body_b, int link_a, int link_b, bool enabled);
  void set_collision_mask(int body, int link, int group, int mask);

  // ---- shapes (client_shapes.cpp) ------------------------------------------------------------------------------
  int create_shape(std::vector<ShapeRecord> parts, GeomRole role);
  void remove_shape(int id);
  int create_body(const MultiBodyRequest& request, const Transform<double>& X_WB);

  // ---- looks (client_looks.cpp) --------------------------------------------------------------------------------
  void change_visual(int body, int link, const VisualChange& change);
  [[nodiscard]] const std::array<float, 4>& rgba(int body, int link, std::size_t shape) const;
  [[nodiscard]] int texture(int body, int link, std::size_t shape) const;  ///< -1: its own
  int add_texture(std::shared_ptr<const Image> image);
  void change_texture(int texture, std::shared_ptr<const Image> image);
  /// `read`: of the files that models name.
  void take_picture(const PictureRequest& request, const PictureResult& result, const ImageReader& read = {});

  // ---- the screen (client_screen.cpp) --------------------------------------------------------------------------
  /// What the screen shows now, to who has seen the items and colours up to these numbers. Changes no bit of the world.
  [[nodiscard]] ScreenFrame frame(std::int64_t seen_items, std::int64_t seen_looks, bool with_model);

  // ---- saved states (client_states.cpp) ------------------------------------------------------------------------
  int save_state();
  void restore_state(int id);
  void remove_state(int id);

 private:
  struct Body;

  [[nodiscard]] Body* find(int body);
  [[nodiscard]] const Body* find(int body) const;
  [[nodiscard]] Body& at(int body, const char* error);
  [[nodiscard]] const Body& at(int body, const char* error) const;
  void require_joint(const Body* body, int joint, const char* error = kJointRange) const;
  void locate(Body& body);
  void locate_all();
  void own_links(const Body& body);
  [[nodiscard]] LinkId link_id(Body& body, int link);
  [[nodiscard]] JointId joint_id(Body& body, int joint);
  [[nodiscard]] int fresh_id() const;
  void take_notes(const LoadReport& report);
  std::vector<int> add_all(const LoadedModel& loaded, const LoadOptions& options, bool from_mjcf);
  [[nodiscard]] Transform<double> inertial_pose(Body& body, int link);
  [[nodiscard]] Motion<double> inertial_velocity(Body& body, int link);
  void set_motor(Body& body, int joint, const MotorSetting& setting);
  void write_motor(Body& body, int joint);
  void write_inertial(Body& body, int link);
  void write_surface(Body& body, int link);
  void replace(Body& body);
  void apply_damping(Body& body);
  void apply_motors(Body& body, double h);
  void apply_pd(Body& body, int joint, double h);
  void stop_pd(Body& body, int joint);
  void apply_ball_motor(Body& body, int joint, double h);
  void cap_speeds(Body& body);
  void clear_torques();
  void keep_contacts();
  void apply_filters(int body);
  [[nodiscard]] bool counts(const WorldRayHit& hit, int mask);
  [[nodiscard]] bool may_collide(const Body& a, int link_a, const Body& b, int link_b) const;
  void drop_constraint(int id);
  void write_constraints();
  void approach_constraints();
  [[nodiscard]] EqualityConstraint equality_of(int id, const UserConstraint& constraint);
  [[nodiscard]] static Mechanism& mechanism_of(Body& body);
  [[nodiscard]] Guise guise_of(const Model& model);
  [[nodiscard]] bool has_link(int body, int link) const;
  void show_items(std::int64_t seen, ScreenFrame& frame);
  void follow_grips(double h);
  void release_grips();

  World world_;
  Settings settings_;
  Decomposer decompose_;
  std::unique_ptr<Screen> screen_;
  std::int64_t scene_ = 0, looks_ = 0;  // of ScreenFrame
  bool holds_ = false;                  // whether there are constraints of grips in the world
  UserData user_data_;
  int next_log_ = 0;
  std::map<int, std::unique_ptr<Body>> bodies_;
  std::vector<int> order_;  // serial numbers
  std::vector<int> freed_;
  int next_id_ = 0;
  std::vector<std::array<int, 2>> owners_;  // (links of the world) body and link
  std::int64_t edition_ = 0;
  std::vector<std::array<int, 2>> torqued_;  // joints whose tau is to be taken back
  std::map<int, UserConstraint> constraints_;
  std::vector<int> constraint_order_;  // serial numbers
  int next_constraint_ = 1;
  std::vector<ContactReading> contacts_;
  bool contacts_known_ = true;
  std::map<std::array<int, 4>, bool> pair_rules_;
  std::map<int, std::shared_ptr<const std::vector<ShapeRecord>>> collision_shapes_, visual_shapes_;
  int next_collision_ = 0, next_visual_ = 0;
  std::map<int, std::shared_ptr<const Image>> textures_;
  std::map<int, std::vector<std::uint8_t>> states_;
  std::vector<std::string> notes_;
};

}  // namespace manyhands::bullet
