// Names of things in a world that know when the thing is gone.
#pragma once

// The cheapest header that has std::hash.
#include <typeindex>

#include "physics/base/config.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// The index of nothing.
inline constexpr std::uint32_t null_index = 0xffffffffu;

}  // namespace detail

/// A small value that names a body, a shape... of one world. It stays unique when its slot is used again,
/// and a world recognises handles of another. The default one is null. It may be a key of std::map and
/// std::unordered_map.
template <class Tag>
struct handle {
    std::uint32_t index = detail::null_index;
    std::uint16_t generation = 0;
    std::uint16_t world = 0;

    /// False for the null handle; true says nothing about whether the thing still lives.
    constexpr explicit operator bool() const { return index != detail::null_index; }
    friend bool operator==(handle, handle) = default;
    /// An order for maps; it says nothing of what came first.
    friend constexpr auto operator<=>(handle, handle) = default;
};

/// Tells handles of bodies from others.
struct body_tag;
/// Tells handles of shapes from others.
struct shape_tag;
/// Tells handles of joints from others.
struct joint_tag;
/// Names a body of a world.
using body_id = handle<body_tag>;
/// Names a shape of a world.
using shape_id = handle<shape_tag>;
/// Names a joint of a world.
using joint_id = handle<joint_tag>;

PHYSICS_HPP_END

/// Of handles, as keys of std::unordered_map.
template <class Tag>
struct std::hash<physics::handle<Tag>> {
    std::size_t operator()(physics::handle<Tag> id) const noexcept {
        const std::uint64_t all = std::uint64_t{id.world} << 48 | std::uint64_t{id.generation} << 32 | id.index;
        return static_cast<std::size_t>(all * 0x9e3779b97f4a7c15u >> 32);
    }
};
