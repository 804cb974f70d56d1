// The library with numbers of twice the digits of a double (about 31): what other runs are measured against where no
// closed form is known. An engine that is a template needs only another scalar for that.
// peer: qd/dd_real.h=libqd-dev -lqd
#include <qd/dd_real.h>

#include "../scenes/ours.hpp"

namespace bench {

namespace {

struct double_double {
    dd_real value = 0.0;

    double_double() = default;
    explicit double_double(int x) : value(x) {}
    explicit double_double(double x) : value(x) {}
    explicit double_double(const dd_real& x) : value(x) {}
    explicit operator double() const { return to_double(value); }

    friend double_double operator+(const double_double& a, const double_double& b) {
        return double_double(a.value + b.value);
    }
    friend double_double operator-(const double_double& a, const double_double& b) {
        return double_double(a.value - b.value);
    }
    friend double_double operator-(const double_double& a) { return double_double(-a.value); }
    friend double_double operator*(const double_double& a, const double_double& b) {
        return double_double(a.value * b.value);
    }
    friend double_double operator/(const double_double& a, const double_double& b) {
        return double_double(a.value / b.value);
    }
    double_double& operator+=(const double_double& b) { return *this = *this + b; }
    double_double& operator-=(const double_double& b) { return *this = *this - b; }
    double_double& operator*=(const double_double& b) { return *this = *this * b; }
    double_double& operator/=(const double_double& b) { return *this = *this / b; }
    friend bool operator==(const double_double& a, const double_double& b) { return a.value == b.value; }
    friend bool operator<(const double_double& a, const double_double& b) { return a.value < b.value; }
    friend bool operator>(const double_double& a, const double_double& b) { return a.value > b.value; }
    friend bool operator<=(const double_double& a, const double_double& b) { return a.value <= b.value; }
    friend bool operator>=(const double_double& a, const double_double& b) { return a.value >= b.value; }
};

}  // namespace

}  // namespace bench

template <>
struct physics::scalar_traits<bench::double_double> {
    using scalar = bench::double_double;
    using wide = scalar;
    using inverse = scalar;
    using real = scalar_traits<double>;
    static const char* name() { return "double_double"; }
    static scalar epsilon() { return scalar(0x1p-104); }
    static scalar max() { return scalar(real::max()); }
    static bool is_finite(const scalar& x) { return real::is_finite(x.value.x[0]); }
    static std::uint64_t bits(const scalar& x) {
        return real::bits(x.value.x[0]) ^ real::bits(x.value.x[1]) * 0x9e3779b97f4a7c15u;
    }
    static scalar sqrt(const scalar& x) { return scalar(::sqrt(x.value)); }
    static scalar floor(const scalar& x) { return scalar(::floor(x.value)); }
    static scalar sin(const scalar& x) { return scalar(::sin(x.value)); }
    static scalar cos(const scalar& x) { return scalar(::cos(x.value)); }
    static scalar tan(const scalar& x) { return scalar(::tan(x.value)); }
    static scalar exp(const scalar& x) { return scalar(::exp(x.value)); }
    static scalar log(const scalar& x) { return scalar(::log(x.value)); }
    static scalar acos(const scalar& x) { return scalar(::acos(x.value)); }
    static scalar atan2(const scalar& y, const scalar& x) { return scalar(::atan2(y.value, x.value)); }
};

namespace bench {

namespace {

using kinds_of_joints = physics::joints<physics::ball_joint, physics::revolute_joint, physics::weld_joint>;

const enlisted wide({.name = "reference",
                     .settings = "substeps",
                     .make = make_ours<double_double, physics::soft_step, by_oneself, kinds_of_joints>,
                     .has_joints = true,
                     .on_demand = true});

}  // namespace

}  // namespace bench
