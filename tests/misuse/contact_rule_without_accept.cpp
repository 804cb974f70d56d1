// expect: physics::recipe: the contact rule has no static accept(candidate) that answers a bool; see contact_candidate
#include <physics.hpp>

struct by_number {
    using stage = physics::stage::contact_rule;
    template <class Candidate>
    static int accept(const Candidate&) {
        return 1;
    }
};
struct mine : physics::recipe<float, 2, by_number> {};

int main() {
    physics::world<mine> world;
    world.step(1.0f / 60);
}
