// The one judge of all engines: it sees poses and velocities only, works in double, and takes nobody's word for a
// contact. Overlaps are exact: separating axes for polygons and polytopes, closed forms for balls; of capsules and
// cylinders in space they are searched for, to a hundredth of a millimetre.
#pragma once

#include <set>
#include <utility>
#include <vector>

#include "scene.hpp"

namespace bench {

/// Mass, centre and inertia about it in the body's frame, as they follow from the shapes.
struct mass {
    double value = 0;
    triple center = {};
    /// Rows.
    std::array<triple, 3> inertia = {};
};
mass mass_of(const body& b, int dimension);

/// A shape as the judge sees it, or a segment of a chain, or a triangle of a mesh: the hull of a few points, grown by a
/// radius; of a cylinder each point is a disc across its axis.
struct piece {
    int body = 0;
    bool pushed = false;
    std::vector<triple> points;
    double radius = 0, disc = 0;
    /// In the plane the unit normals of its edges, outwards; in space its axes: unit normals of faces up to sign.
    std::vector<triple> normals;
    /// Directions of edges, in space only; of a capsule or cylinder its axis.
    std::vector<triple> edges;
};

/// In the frame of the body.
std::vector<piece> pieces_of(const shape& s, int dimension);
piece moved(piece p, const state& at);

/// How deep two pieces overlap (m): at least 0, and 0 if they do not.
double overlap(const piece& a, const piece& b, int dimension);

struct verdict {
    /// Depth of the deepest overlap ever sampled, at the end, and the mean over overlaps at the end (m).
    double worst = 0, last = 0, mean = 0;
    /// Overlaps deeper than 5 mm at the end.
    int deep = 0;
    /// How far a top has sunk and drifted sideways at the end, at most (m).
    double sag = 0, drift = 0;
    /// Kinetic energy at the end (J).
    double energy = 0;
    /// The largest distance between points that a joint holds together, of all steps, and the mean (m).
    double gap = 0, mean_gap = 0;
    /// Who is not where anybody could be.
    int lost = 0;
};

class judge {
public:
    explicit judge(const scene& s);
    /// What an engine says of a fresh world; empty if it is what the scene says.
    [[nodiscard]] std::string complaint(const std::vector<state>& states, const triple& gravity) const;
    void sample(const std::vector<state>& states);
    /// Looks at the joints alone: after each step.
    void watch(const std::vector<state>& states);
    [[nodiscard]] const verdict& result() const { return result_; }

private:
    const scene& scene_;
    std::vector<piece> pieces_;
    std::vector<mass> masses_;
    /// Bodies that are joined, the lower number first.
    std::set<std::pair<int, int>> joined_;
    double gaps_ = 0;
    std::size_t seen_ = 0;
    verdict result_;
};

}  // namespace bench
