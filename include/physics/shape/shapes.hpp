// The closed set of shapes that a recipe uses: one value that holds any of them, no virtual calls.
#pragma once

#include "physics/shape/ball.hpp"
#include "physics/shape/box.hpp"
#include "physics/shape/capsule.hpp"
#include "physics/shape/geometry.hpp"
#include "physics/shape/halfspace.hpp"

PHYSICS_HPP_BEGIN

namespace detail {
/// A shape that refers to a block of geometry.
template <class Shape>
concept refers_to_geometry = requires(const Shape s) {
    { s.geometry } -> std::convertible_to<const geometry_block*>;
};
}  // namespace detail

/// A value that holds one shape of a closed set. Size: the largest shape and its number.
template <class S, int D, template <class, int> class... Shapes>
class any_shape {
public:
    static constexpr int kinds = sizeof...(Shapes);
    /// The number of a shape within the set, -1 if it is not of the set.
    template <class Shape>
    static constexpr int kind_of() {
        constexpr bool same[] = {std::is_same_v<Shape, Shapes<S, D>>...};
        for (int i = 0; i < kinds; ++i)
            if (same[i]) return i;
        return -1;
    }

    any_shape() : any_shape(first{}) {}
    template <class Shape>
        requires(kind_of<Shape>() >= 0)
    any_shape(const Shape& shape) : kind_(kind_of<Shape>()) { new (static_cast<void*>(bytes_)) Shape(shape); }

    [[nodiscard]] int kind() const { return kind_; }
    /// The shape, which must be of that type.
    template <class Shape>
    [[nodiscard]] const Shape& get() const {
        return *std::launder(reinterpret_cast<const Shape*>(bytes_));
    }
    /// Whether any shape of the set refers to geometry, and the block that this one refers to; null if to none.
    static constexpr bool has_geometry = (detail::refers_to_geometry<Shapes<S, D>> || ...);
    [[nodiscard]] const detail::geometry_block* geometry() const {
        if constexpr (has_geometry)
            return visit([](const auto& shape) -> const detail::geometry_block* {
                if constexpr (detail::refers_to_geometry<std::remove_cvref_t<decltype(shape)>>) return shape.geometry;
                else return nullptr;
            });
        else return nullptr;
    }
    /// Calls f with the shape in its own type.
    template <class F>
    decltype(auto) visit(F&& f) const {
        return visit_from<0, F, Shapes<S, D>...>(f);
    }

private:
    template <int I, class F, class First, class... Rest>
    decltype(auto) visit_from(F& f) const {
        if constexpr (sizeof...(Rest) == 0) return f(get<First>());
        else return kind_ == I ? f(get<First>()) : visit_from<I + 1, F, Rest...>(f);
    }
    template <class First, class...>
    struct head {
        using type = First;
    };
    using first = typename head<Shapes<S, D>...>::type;
    static constexpr std::size_t bytes = [] {
        std::size_t maximum = 0;
        ((maximum = sizeof(Shapes<S, D>) > maximum ? sizeof(Shapes<S, D>) : maximum), ...);
        return maximum;
    }();

    alignas(Shapes<S, D>...) unsigned char bytes_[bytes] = {};
    std::int32_t kind_ = 0;
};

/// No set: only asked for by compilers that take any_shape for a shape's own template (P0522, as clang 19 does).
template <class S, int D>
class any_shape<S, D> {};

template <class S, int D, template <class, int> class... Shapes>
aabb<S, D> bounds(const any_shape<S, D, Shapes...>& shape, const transform<S, D>& at) {
    return shape.visit([&](const auto& s) { return bounds(s, at); });
}

PHYSICS_HPP_END
