// A user's unit that calls inline functions of the library. Prints three hashes: of what they return, which may not
// depend on any flag; of sums in the unit's own code over what they return, which contraction may not change; and of
// sums of products in the unit's own code, which it does change, so that the numbers below can tell.
#include "physics/base/math.hpp"
#include "physics/base/pack_rows.hpp"
#include "physics/base/probe.hpp"

#include <cstdint>
#include <cstdio>
#include <cstring>
#include <initializer_list>

// Like a policy of the user's own, which opens the region itself.
PHYSICS_HPP_BEGIN
namespace detail {
template <class P>
void advance(const typename P::scalar* from, typename P::scalar* to, int n) {
    using S = typename P::scalar;
    const P step = P::broadcast(S(1) / S(60)), one = P::broadcast(S(1));
    for (int i = 0; i < n; i += 4 * P::width) {
        auto rows = load4<P>(consecutive_rows<const S, 4>{from + i});
        for (int k = 0; k < 4; ++k) {
            const P pull = max(rows.x * rows.x + rows.y * rows.y, one - rows.z * rows.w);
            rows.z = rows.z - pull * step;
            rows.w = rows.w + sqrt(pull * pull + one) * step;
            rows.x = rows.x + rows.z * step;
            rows.y = rows.y + rows.w * step;
        }
        store4(consecutive_rows<S, 4>{to + i}, rows);
    }
}
}  // namespace detail
PHYSICS_HPP_END

namespace {

constexpr int count = 1024;

struct hash {
    std::uint64_t value = 14695981039346656037u;
    template <class S>
    void add(S x) {
        unsigned char bytes[sizeof x];
        std::memcpy(bytes, &x, sizeof x);
        for (unsigned char byte : bytes) value = (value ^ byte) * 1099511628211u;
    }
};

/// Numbers from 1 to 2, of which the compiler knows nothing.
template <class S>
S next() {
    static volatile std::uint32_t state = 12345;
    state = state * 1664525u + 1013904223u;
    const S fraction = static_cast<S>(state >> 8) / static_cast<S>(1 << 24);
    return S(1) + fraction;
}

template <class S>
void run(hash& library, hash& border, hash& own) {
    static S a[count], b[count], c[count], results[count];
    for (int i = 0; i < count; ++i) a[i] = next<S>(), b[i] = next<S>(), c[i] = -next<S>();

    for (int i = 0; i < count; ++i) border.add(physics::product(a[i], b[i]) + c[i]);
    for (int i = 0; i < count; ++i) border.add(physics::mul<S>(a[i], b[i]) - physics::mul<S>(b[i], c[i]));
    for (int i = 0; i < count; ++i) border.add(c[i] + physics::product(a[i], a[i]) / physics::sqrt(b[i]));
    for (int i = 0; i < count; ++i) own.add(a[i] * b[i] + c[i]);

    for (int i = 0; i < count; ++i) {
        library.add(physics::sin(a[i]));
        library.add(physics::cos(b[i]));
        library.add(physics::atan2(a[i], c[i]));
        library.add(physics::exp(b[i]));
        library.add(physics::log(a[i]));
    }
    using physics::detail::advance;
    using physics::detail::pack;
    advance<pack<S, 1>>(a, results, count);
    for (S x : results) library.add(x);
    advance<pack<S, 4>>(b, results, count);
    for (S x : results) library.add(x);
    advance<pack<S, 8>>(c, results, count);
    for (S x : results) library.add(x);
}

}  // namespace

int main() {
    const physics::float_control_scope scope;
    hash library, border, own;
    run<float>(library, border, own);
    run<double>(library, border, own);
    for (const hash& h : {library, border, own}) std::printf("%016llx\n", static_cast<unsigned long long>(h.value));
}
