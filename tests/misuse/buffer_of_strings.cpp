// expect: physics::buffer: the values must be trivially copyable
#include <physics.hpp>

#include <string>

physics::buffer<std::string> names;
