// A unit of the same program under other options: they enter the name of the inline namespace.
#define PHYSICS_HPP_AUDIT
#define PHYSICS_HPP_NO_INT128
// The recipe derives from another type here, so it has to have another name.
#define shared_recipe shared_recipe_audited
#include "odr.hpp"

int overflows_in_audited() {
    physics::reset_overflow_count();
    const physics::fixed32 wrapped = physics::fixed32::from_raw(INT64_MAX) + physics::fixed32(1);
    return wrapped < physics::fixed32(0) ? static_cast<int>(physics::overflow_count()) : -1;
}

std::uint64_t shared_hash_in_audited() { return hash_of_landing<shared_recipe>(); }
