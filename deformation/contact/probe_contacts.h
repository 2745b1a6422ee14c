// The contacts of one probe, carried along with it through the sub-steps of an advance.
#pragma once

#include <limits>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "deformation/contact/contact_solve.h"
#include "deformation/contact/gentle_push.h"
#include "deformation/contact/outer_seat.h"
#include "deformation/contact/starting_impulses.h"
#include "deformation/contact/surface_walk.h"
#include "deformation/model/organ_state.h"
#include "modules/core/touch.h"
#include "modules/core/touch_state.h"
#include "modules/geometry/surface_transfer.h"
#include "modules/scene/scene.h"

namespace palpate::deformation {

/// A contact between two messages from collision. Flat probe surfaces stay the planes they are and
/// move with the probe. Round ones (RoundedSegment) are measured anew in every sub-step against
/// their core: a plane frozen for a period would tilt late as the tissue slides under a fingertip,
/// which feeds energy into the sideways swing of the patch.
struct CarriedContact : Contact {
  static constexpr std::size_t kNoRow = ~std::size_t{0};

  /// Of the sub-step; none where a round probe sees it from behind, and none of fixed tissue.
  std::size_t row = kNoRow;
  bool behind = false;  ///< a round probe's core was found inside, through this wall
  // In the last sub-step, on the tissue, for the next one, however long, to start from [N]:
  double normal_force = 0;
  Vec3 tangential_force = Vec3::Zero();
  /// On fixed tissue, which no step moves: what that gives in the sub-step, on the tissue [N·s].
  struct OnFixed {
    Vec3 normal = Vec3::Zero(), tangential = Vec3::Zero();
    void exchange(StateArchive& archive) { archive(normal, tangential); }
  };
  std::optional<OnFixed> on_fixed;
  /// Of what its triangle's fixed tissue resists with, where several contacts of a sharp tool press
  /// on it: (0, 1], by their depths (share_fixed).
  double fixed_share = 1;
  // On the probe over the advance, in W [N·s]:
  Vec3 pushed = Vec3::Zero();   ///< along the normals
  Vec3 dragged = Vec3::Zero();  ///< by friction

  void exchange(StateArchive& archive) {
    exchange_state(archive, static_cast<Contact&>(*this));
    archive(row, behind, normal_force, tangential_force, on_fixed, fixed_share, pushed, dragged);
  }
};

/// Whether nothing but fixed nodes carries its place.
bool is_on_fixed_nodes(const CarriedContact& contact, const Body& body);

/// What fixed tissue is given in a step of h: along the normal by a spring, across it by one from
/// where it sticks, within the cone.
/// @param row  of the contact, as if the tissue could move
CarriedContact::OnFixed press_fixed(const CarriedContact& contact, const Body& body, double h,
                                    ContactRow row);

/// Contacts are sorted by it.
inline std::pair<std::uint32_t, std::uint32_t> triangle_of(const CarriedContact& contact) {
  return {contact.organ, contact.triangle};
}

class ProbeContacts {
 public:
  /// A round probe's rows are those of all tissue nearer to it than this [m].
  static constexpr double kTouched = 1e-3;
  /// Tissue nearer than this and the way of an advance is watched even when a search, which was
  /// earlier, found it out of reach [m].
  static constexpr double kWatched = 0.03;

  /// @param mesh  of a MeshShape; empty: nothing is known of what it has inside
  explicit ProbeContacts(const scene::Probe& probe, const geometry::TriangleSurface& mesh = {});

  void reset();
  /// Nobody knows where it touches: contacts are dropped, and nothing is watched.
  void forget_contacts();
  /// @param kept_within  contacts are dropped if it, or an end of its core, went further [m]
  void set_pose(const Pose& pose, double kept_within = std::numeric_limits<double>::infinity());
  /// Replaces the contacts, which are sorted by (organ, triangle); one near to where its triangle
  /// had one starts from the forces of that. Where the probe had no contact with an organ and now
  /// has one deeper than GentlePush::kSeenDepth and its own way, that was not seen coming: until it
  /// is out, it is pushed gently (GentlePush).
  void set_contacts(std::span<const Contact> contacts);

  /// An organ's surface gets other triangles. Appends a round probe's core if it was kept outside,
  /// and of a sharp tool that touches it the inner cores that are outside.
  void begin_change(std::uint32_t organ, const SurfaceWalk& surface,
                    std::span<const Vec3> positions, std::vector<CoreLine>& cores);
  /// It has them: contacts stay where they are on it. @returns whether tissue that goes out gently
  /// is deeper in a round probe than it was, and than kUnsolvedDepth: flat triangles lie in the
  /// place of a dent, and the step to come does not hold them off
  bool change_surface(std::uint32_t organ, const geometry::SurfaceTransfer& transfer,
                      const SurfaceWalk& surface, std::span<const Vec3> positions);

  /// Begins an advance of `period` [s], in which the probe moves from where it was to the newest
  /// pose. @returns false if it jumped: its contacts are dropped
  bool begin(double period);
  void end();  ///< ends it

  /// Appends the rows of this probe's contacts with `organ` at `fraction` (0, 1] of the advance.
  /// A row at the sub-step's start is given by the probe at its end, minus the way it moves.
  /// The rows of a round probe are those of its contacts and of all else it touches.
  void append_rows(std::uint32_t organ, SurfaceWalk& surface, const OrganState& state, double h,
                   double fraction, std::vector<ContactRow>& rows);
  /// After a sub-step: did a round probe's core go through the wall? Then a row of its place there
  /// is added, or put in the place of that triangle's, for the sub-step to be taken again; if it is
  /// not, take_rows() comes next.
  bool hold_crossed(std::uint32_t organ, SurfaceWalk& surface, std::span<const Vec3> start,
                    std::span<const Vec3> end, double h, double fraction,
                    std::vector<ContactRow>& rows);
  /// The same where tissue that it sees ended deeper in a round probe than kUnsolvedDepth: all
  /// that is in it and that no row is of gets one. Then a triangle may have several contacts, until
  /// the sub-step is over.
  Missed hold_swallowed(std::uint32_t organ, SurfaceWalk& surface, std::span<const Vec3> start,
                        std::span<const Vec3> end, double h, double fraction,
                        std::vector<ContactRow>& rows);
  /// The same where the wall went over one of a sharp tool's inner cores, or a node ended deeper in
  /// a box than kUnsolvedDepth: its contacts come from the search alone, and what passes between
  /// two of them takes the tool through the wall.
  bool hold_pierced(std::uint32_t organ, SurfaceWalk& surface, std::span<const Vec3> start,
                    std::span<const Vec3> end, double h, double fraction,
                    std::vector<ContactRow>& rows);
  /// hold_crossed(), hold_swallowed() and hold_pierced(), for all probes.
  static Missed hold_missed(std::span<ProbeContacts> probes, std::uint32_t organ,
                            SurfaceWalk& surface, std::span<const Vec3> start,
                            std::span<const Vec3> end, double h, double fraction,
                            std::vector<ContactRow>& rows);
  /// Takes the solved rows back. @param rows  all of the sub-step of h [s]
  /// @returns the number of its own
  std::size_t take_rows(std::uint32_t organ, double h, std::span<const ContactRow> rows);

  /// After take_rows() of all: a wall that the step left across the core of a round probe that was
  /// outside is moved off it (seat_outside), but not where the core is outside all the same: one
  /// folded inside out. @returns whether there was one
  static bool put_back_outside(std::span<ProbeContacts> probes, std::uint32_t organ,
                               SurfaceWalk& surface, std::span<Vec3> positions, double fraction);

  /// As DeformationWorld::holds_on().
  bool holds_on(double within) const;
  bool has_contacts(std::uint32_t organ) const;
  bool touches(std::uint32_t organ) const;
  /// Whether a round probe has contacts there, or had and is still near, so that it may cross the
  /// wall.
  bool may_cross(std::uint32_t organ) const {
    return core_ && (has_contacts(organ) || is_watched(organ));
  }
  /// Whether a step may leave tissue and probe where rows do not hold them, so that it is looked
  /// at.
  bool may_miss(std::uint32_t organ) const {
    return may_cross(organ) || (!inner_cores_.empty() && has_contacts(organ));
  }
  /// Whether penetration of an organ that was not seen coming is being undone.
  bool is_gentle(std::uint32_t organ) const;
  double friction() const { return friction_; }
  double radius() const { return core_ ? core_->radius : 0; }  ///< of a round probe, else 0 [m]
  const Pose& pose() const { return target_; }                 ///< at the end of the advance
  const Vec3& went() const { return went_; }  ///< its origin in the last advance [m]
  /// So many advances further, if it goes on as in this one; no more than its own size.
  Pose ahead(double advances) const;
  Vec3 impulse() const;  ///< on the probe over the advance [N·s]
  const std::vector<CarriedContact>& contacts() const { return contacts_; }

  /// Between two advances.
  void exchange(StateArchive& archive) {
    archive(placed_, searched_, start_, target_, found_at_, went_, period_, contacts_,
            previous_contacts_, near_, gentle_, begun_);
  }

 private:
  Pose pose_at(double fraction) const;
  /// What a round probe's core is near in an organ.
  struct Near {
    std::uint32_t organ = 0;
    /// The core is inside at the sub-step's start. One outside stays so while no crossing is let
    /// pass: where a wall is folded through itself the nearest triangle tells nothing.
    bool inside = true;
    bool crossed = false;                  ///< in the sub-step as it was last taken
    bool went_through = false;             ///< … what is fixed, all or in part, and yields
    bool watched = false;                  ///< nearer than kWatched and the way of the advance
    std::vector<std::uint32_t> triangles;  ///< the nearest among them
    void exchange(StateArchive& archive) { archive(organ, inside, crossed, watched, triangles); }
  };
  Near& near_of(std::uint32_t organ);
  void take_seeds(const Near& near);
  /// Where the probe is clear of an organ that searches found out of reach: what is nearest there.
  void watch_from_afar(std::uint32_t organ, SurfaceWalk& surface, const OrganState& state,
                       const Pose& pose);
  /// Looks around the core; what it touches and has no contact gets one.
  void look_around(std::uint32_t organ, SurfaceWalk& surface, const OrganState& state,
                   const Pose& pose);
  void take_forces_of_previous(CarriedContact& carried);
  void unite_contacts(std::uint32_t organ);
  CarriedContact& contact_on(std::uint32_t organ, std::uint32_t triangle);
  /// Appends the core if the step may have left it across a wall that it was outside of: no row
  /// held it, or it lies through a triangle. No crossing within the step may have told: one over an
  /// edge of a fold that is turned inside out looks like one from within.
  void append_crossed(std::uint32_t organ, SurfaceWalk& surface, std::span<const Vec3> positions,
                      double fraction, std::vector<CoreLine>& cores);
  static CoreWay way_of(const geometry::RoundedSegment& core, const Pose& before,
                        const Pose& after);
  /// On the wall where a core of the probe went through it.
  static void put_at(const WallCrossing& crossing, const geometry::RoundedSegment& core,
                     const Pose& pose, CarriedContact& contact);
  void find_crossings(SurfaceWalk& surface, std::span<const Vec3> start, std::span<const Vec3> end,
                      const CoreWay& core);
  bool hold_at(const WallCrossing& crossing, std::uint32_t organ, const SurfaceWalk& surface,
               std::span<const Vec3> start, const Pose& before, const Pose& after, double h,
               std::vector<ContactRow>& rows);
  void share_fixed(std::uint32_t organ, const Body& body, std::span<const Vec3> positions,
                   const Pose& before, const Pose& after, double h);
  /// Puts a contact that the search did not tell among the others, and its row at the end.
  void add_row(CarriedContact contact, const ContactRow& row, std::vector<ContactRow>& rows);
  void hold_nodes_in_box(std::uint32_t organ, std::span<const std::uint32_t> triangles,
                         const SurfaceWalk& surface, std::span<const Vec3> start,
                         std::span<const Vec3> end, const Pose& before, const Pose& after, double h,
                         std::vector<ContactRow>& rows);
  /// How deep tissue that a round probe's core sees from outside is in it, between two advances:
  /// exact, a look at each triangle [m].
  double deepest_tissue(std::uint32_t organ, const SurfaceWalk& surface,
                        std::span<const Vec3> positions) const;
  double way_to_tissue(const SurfaceWalk& surface, std::span<const Vec3> start,
                       std::span<const Vec3> end, const Pose& before, const Pose& after) const;
  const ContactRow* row_at(std::uint32_t organ, const Vec3& place, std::span<const Vec3> end,
                           std::span<const ContactRow> rows) const;
  bool is_yielding_held(std::uint32_t organ, std::uint32_t triangle,
                        std::span<const ContactRow> rows) const;
  /// Weights, point and normal of a round probe's contact for tissue and probe as they are.
  /// @returns false if it is seen from behind by a core outside: the wall is not touched there
  bool measure_again(const SurfaceWalk& surface, const OrganState& state, const Pose& pose,
                     bool inside, CarriedContact& contact) const;
  ContactRow row_of(const CarriedContact& contact, const Body& body,
                    std::span<const Vec3> positions, const Pose& before, const Pose& after,
                    double h) const;
  /// Of the probe's origin in this advance [m].
  double way() const { return (target_.position - start_.position).norm(); }
  bool is_behind(const Contact& contact) const;
  bool knows(std::uint32_t organ) const;  ///< what it is near there
  bool is_watched(std::uint32_t organ) const;
  bool is_kept_outside(std::uint32_t organ) const;
  void note_begun();
  void be_gentle(std::uint32_t organ, const OrganState& state, double h,
                 std::span<ContactRow> rows);

  double friction_;
  std::optional<geometry::RoundedSegment> core_;
  bool is_sharp_ = false;                              ///< a box, a mesh, a cone or a grasper
  std::vector<geometry::RoundedSegment> inner_cores_;  ///< of a sharp tool
  std::optional<Vec3> half_extents_;                   ///< of a box [m]
  bool placed_ = false;
  bool searched_ = false;  ///< a search has told of it since it was placed, jumped or fell silent
  Pose start_, target_;
  Pose found_at_;  ///< where it was when a search's contacts came
  Vec3 went_ = Vec3::Zero();
  double deepest_ = 0;  ///< tissue in a round probe as a change of surface began [m]
  double period_ = 0;
  std::vector<CarriedContact> contacts_, previous_contacts_;
  std::vector<Near> near_;               ///< by organ it is or was near
  std::vector<NearTriangle> found_;      ///< buffer
  std::vector<std::uint32_t> seeds_;     ///< buffer
  std::vector<WallCrossing> crossings_;  ///< buffer
  std::vector<GentlePush> gentle_;
  std::vector<std::uint32_t> begun_;  ///< organs first touched by the newest contacts
};

}  // namespace palpate::deformation
