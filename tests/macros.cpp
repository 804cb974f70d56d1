// After headers whose macros take the library's names: it compiles, and they have their macros back.
#include <doctest/doctest.h>

// <windows.h>, <complex.h>, debuggers of memory, the C library's older names.
#define near
#define far
#define huge
#define small char
#define min(a, b) (((a) < (b)) ? (a) : (b))
#define max(a, b) (((a) > (b)) ? (a) : (b))
#define I (__extension__ 1.0i)
#define imaginary _Imaginary
#if defined(__clang__)
#pragma clang diagnostic ignored "-Wkeyword-macro"
#endif
#define new new (__FILE__, __LINE__)
#define index strchr
// Qt, Unreal, Arduino, <curses.h>.
#define emit
#define slots
#define check(expression) static_cast<void>(0)
#define F(text) (text)
#define abs(x) ((x) > 0 ? (x) : -(x))
#define round(x) ((x) >= 0 ? (long)((x) + 0.5) : (long)((x)-0.5))
#define radians(degrees) ((degrees)*0.0174532925)
#define bit(n) (1UL << (n))
#define word(...) makeWord(__VA_ARGS__)
#define high 1
#define low 0
#define clear() wclear(stdscr)
#define erase() werase(stdscr)
#define move(y, x) wmove(stdscr, y, x)
#define border(a, b, c, d, e, f, g, h) wborder(stdscr, a, b, c, d, e, f, g, h)
#define box(w, v, h) wborder(w, v, v, h, h, 0, 0, 0, 0)
#define insert(x) winsert(stdscr, x)
// What programs define for themselves.
#define clamp(x, a, b) ((x) < (a) ? (a) : (x) > (b) ? (b) : (x))
#define swap(a, b)  \
    do {            \
        auto c = a; \
        a = b;      \
        b = c;      \
    } while (0)
#define remove(x) ((x) = 0)
#define reflect(x) (-(x))
#define unlikely(x) __builtin_expect(!!(x), 0)
#define real float
#define step(x) ((x) > 0)
#define norm(x) ((x) * (x))
#define pi 3.14159f
#define half 0.5f
#define length(x) (sizeof(x) / sizeof(*(x)))
#define distance(a, b) ((a) - (b))

#include <physics.hpp>

#if !defined(near) || !defined(min) || !defined(check) || !defined(new) || bit(3) != 8 || high != 1
#error "macros were lost"
#endif
#undef step
#undef min
#undef max
#undef abs
#undef swap
#undef move
#undef erase
#undef new

template <class Scalar, int Dimension>
struct crates : physics::recipe<Scalar, Dimension> {};

template <class World>
void falls() {
    World w;
    w.create_shape(w.create_body({.type = physics::body_type::static_body}), typename World::halfspace{});
    typename World::body_def def;
    def.position.y = typename World::scalar(1);
    const physics::body_id crate = w.create_body(def);
    using crate_shape = typename World::ball;
    w.create_shape(crate, crate_shape{});
    for (int i = 0; i < 60; ++i) w.step(typename World::scalar(1.0 / 64));
    CHECK(static_cast<double>(w.position(crate).y) < 0.6);
}
TEST_CASE("macros: the library compiles after those of other headers, and runs") {
    falls<physics::world<crates<float, 2>>>();
    falls<physics::world<crates<physics::fixed32, 3>>>();
}
