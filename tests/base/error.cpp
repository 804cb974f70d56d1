// Errors: the sentence names function, field, value and rule; the handler is for builds without exceptions.
#include <doctest/doctest.h>

#include <physics/base/error.hpp>

#include <exception>
#include <limits>
#include <string>

namespace {

/// What a refused call says.
template <class... Arguments>
std::string sentence(Arguments... arguments) {
    try {
        physics::refuse(arguments...);
    } catch (const std::exception& failure) {
        return failure.what();
    }
    return "nothing thrown";
}

int calls = 0;
void count(const physics::error&) { ++calls; }

}  // namespace

TEST_CASE("error: one sentence names function, field, value and rule") {
    CHECK(sentence("step", "dt", "null", "it must be there") == "physics: step: dt is null; it must be there");
    CHECK(sentence("step", "dt", -0.25, "it must be greater than 0") ==
          "physics: step: dt is -0.25; it must be greater than 0");
    CHECK(sentence("create_body", "position", ".x", 2.0, "it must be 1") ==
          "physics: create_body: position.x is 2; it must be 1");
}

TEST_CASE("error: values read the same on every system") {
    using limits = std::numeric_limits<double>;
    const auto value = [](double x) {
        const std::string said = sentence("f", "x", x, "no");
        return said.substr(17, said.find(';') - 17);
    };
    CHECK(value(limits::quiet_NaN()) == "nan");
    CHECK(value(-limits::quiet_NaN()) == "nan");
    CHECK(value(limits::infinity()) == "inf");
    CHECK(value(-limits::infinity()) == "-inf");
    CHECK(value(1e300) == "1e+300");
    CHECK(value(0.1) == "0.1");
    CHECK(value(123456789) == "123456789");
}

TEST_CASE("error: a sentence that is too long is cut, not overrun") {
    const std::string word(300, 'x');
    const std::string said = sentence(word.c_str(), "field", word.c_str(), "rule");
    CHECK(said.size() == 255);
    CHECK(said.rfind("physics: xxx", 0) == 0);
    CHECK(sentence("f", word.c_str(), ".x", 1.0, "rule").size() < 256);
}

TEST_CASE("error: builds with exceptions throw and leave the handler alone") {
    const physics::error_handler standard = physics::set_error_handler(count);
    CHECK(sentence("f", "x", 1.0, "no") == "physics: f: x is 1; no");
    CHECK(calls == 0);
    CHECK((physics::set_error_handler(nullptr) == &count));
    CHECK((physics::set_error_handler(nullptr) == standard));
}
