// A build with -fno-exceptions -fno-rtti: refused calls go to the error handler, and if that returns, nothing happened.
#define DOCTEST_CONFIG_NO_EXCEPTIONS
#include <doctest/doctest.h>

#include <physics.hpp>

#include <cstdint>
#include <limits>
#include <string>

#if defined(__cpp_exceptions) || defined(__GXX_RTTI)
#error "this unit is meant to be built with -fno-exceptions -fno-rtti"
#endif

namespace {

int refusals = 0;
std::string last;

void remember(const physics::error& failure) {
    ++refusals;
    last = failure.what();
}

/// Counts the refusals of one test case, and puts the former handler back.
class listening {
public:
    listening() : former_(physics::set_error_handler(remember)) { refusals = 0; }
    ~listening() { physics::set_error_handler(former_); }
    listening(const listening&) = delete;
    listening& operator=(const listening&) = delete;

private:
    physics::error_handler former_;
};

}  // namespace

TEST_CASE("no exceptions: the handler is set, called with the sentence, and restored") {
    const physics::error_handler standard = physics::set_error_handler(remember);
    CHECK((physics::set_error_handler(nullptr) == &remember));
    CHECK((physics::set_error_handler(standard) == standard));
    const listening scope;
    CHECK_FALSE(physics::detail::refuse("create_body", "mass", -1.5, "it must not be negative"));
    CHECK(refusals == 1);
    CHECK(last == "physics: create_body: mass is -1.5; it must not be negative");
}

TEST_CASE("no exceptions: a refused call names itself, returns null or zero, and changes nothing") {
    struct plain : physics::recipe<double, 2> {};
    physics::world<plain> world;
    const auto ball = world.create_body();
    world.create_shape(ball, physics::world<plain>::ball{});
    const std::uint64_t before = world.state_hash();
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const listening scope;

    CHECK_FALSE(world.contains(world.create_body({.position = {0, nan}})));
    CHECK(refusals == 1);
    CHECK(last.find("create_body: position") != std::string::npos);
    CHECK(last.find("nan") != std::string::npos);
    CHECK_FALSE(world.contains(world.create_shape(ball, physics::world<plain>::ball{-1.0})));
    CHECK(refusals == 2);
    CHECK(last.find("create_shape: radius is -1") != std::string::npos);
    world.set_linear_velocity({}, {1, 0});
    CHECK(refusals == 3);
    CHECK(last.find("set_linear_velocity: body is null") != std::string::npos);
    CHECK(world.position({}) == physics::vec<double, 2>());
    world.step(0);
    CHECK(refusals == 5);
    CHECK(last.find("step: dt is 0") != std::string::npos);
    CHECK(world.steps() == 0);
    CHECK(world.state_hash() == before);
}
