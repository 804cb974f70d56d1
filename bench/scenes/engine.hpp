// What an engine has to offer to take part, and the list of those that do. Further engines are linked in: a unit of
// their own holds an adapter and an `enlisted`.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "scene.hpp"

namespace bench {

class engine {
public:
    engine() = default;
    engine(const engine&) = delete;
    engine& operator=(const engine&) = delete;
    virtual ~engine() = default;

    /// An empty world with the scene's gravity: damping off, sleeping as the scene says, the rest as
    /// it ships.
    virtual void begin(const scene& s) = 0;
    /// Adds the next body of the scene.
    virtual void add(const body& b) = 0;
    /// Joins two bodies that have been added; asked of those alone who can.
    virtual void join(const joint&) {}
    /// Velocities of a driven body from now on.
    virtual void drive(int body, const triple& velocity, const triple& spin) = 0;
    virtual void step(double dt) = 0;
    /// Of all bodies so far, in their order.
    virtual void read(std::vector<state>& states) const = 0;
    /// As the engine itself knows it.
    [[nodiscard]] virtual triple gravity() const = 0;
    /// Pairs of shapes that touch in at least one point.
    [[nodiscard]] virtual int contacts() const = 0;
    /// Free bodies that are not asleep; -1 if unknown.
    [[nodiscard]] virtual int awake() const { return -1; }
    /// What each contact takes of the state that lasts from step to step, memories of pairs included; 0 if unknown.
    [[nodiscard]] virtual double contact_bytes() const { return 0; }
    /// For those that can tell: names of stages and their ns so far, and sizes worth knowing.
    [[nodiscard]] virtual std::vector<std::pair<std::string, double>> stages() const { return {}; }
};

struct contestant {
    std::string name;
    /// What it runs with: iterations, slop and the like.
    std::string settings;
    /// 2, 3, or 0 for both.
    int dimension = 0;
    /// In which order they are shown; ours come first, and the one with 0 is what others are compared with.
    int order = 100;
    std::unique_ptr<engine> (*make)(int dimension) = nullptr;
    /// Whether it can, and should, play a scene of its dimension; null: any.
    bool (*plays)(const scene& s) = nullptr;
    /// Whether it plays scenes with joints.
    bool has_joints = false;
    /// Takes part only if it is named, or asked for by --stages.
    bool on_demand = false;

    [[nodiscard]] bool joins(const scene& s) const {
        return (dimension == 0 || dimension == s.dimension) && (has_joints || s.joints.empty()) &&
               (plays == nullptr || plays(s));
    }
};

inline std::vector<contestant>& contestants() {
    static std::vector<contestant> all;
    return all;
}

/// Static objects of this type enlist contestants before main() begins.
struct enlisted {
    explicit enlisted(contestant who) { contestants().push_back(std::move(who)); }
};

}  // namespace bench
