// How often each law of certificates was kept, and how nearly not.
#pragma once

#include "specimens.hpp"

namespace {
namespace certificates_laws {

namespace law {
enum name {
    converged,
    unit_normal,
    parts_so_far,
    apart_proven,
    on_surfaces,
    across,
    least_proven,
    least_refuted,
    warm,
    mirrored,
    agreed,
    touching,
    contact_normal,
    contact_points,
    contact_depth,
    contact_features,
    count
};
}
inline const char* name_of(law::name of) {
    constexpr const char* names[] = {"the search converged",
                                     "the normal is a unit vector",
                                     "the normal parts them as far as it says",
                                     "apart: proven by points and normal",
                                     "the points are on the surfaces",
                                     "the points lie across",
                                     "overlap: proven by all faces",
                                     "overlap: not refuted by directions",
                                     "warm equals cold",
                                     "swapped mirrors",
                                     "distance and overlap agree",
                                     "a contact is there if it must be",
                                     "contact: the normal",
                                     "contact: points on both surfaces",
                                     "contact: depths",
                                     "contact: features differ"};
    return names[of];
}

/// How often a law was kept, and how nearly not.
class tally {
public:
    struct entry {
        std::uint64_t judged = 0, broken = 0, broken_in[states] = {};
        /// The largest error, in parts of what is allowed.
        double worst = 0;
        std::string text;
    };
    entry of[law::count];

    void note(law::name l, const meet& m, double off, double allowed) {
        entry& e = of[l];
        ++e.judged;
        const bool broken = !(off <= allowed);
        e.broken += broken;
        e.broken_in[static_cast<int>(m.in)] += broken;
        const double part = allowed > 0 ? off / allowed : broken ? HUGE_VAL : 0;
        if (!(part > e.worst) && !(broken && e.text.empty())) return;
        e.worst = part;
        if (!broken) return;
        char text[120];
        std::snprintf(text, sizeof text, "%s: off by %.6g, allowed %.6g, %s", name_of(l), off, allowed, name_of(m.in));
        e.text = text + text_of(convex_encounter{m.a->shape, m.b->shape, m.b_in_a});
    }
    void add(const tally& t) {
        for (int l = 0; l < law::count; ++l) {
            of[l].judged += t.of[l].judged;
            of[l].broken += t.of[l].broken;
            for (int in = 0; in < states; ++in) of[l].broken_in[in] += t.of[l].broken_in[in];
            if (t.of[l].worst > of[l].worst) of[l].worst = t.of[l].worst;
        }
    }
    void print() const {
        for (int l = 0; l < law::count; ++l) {
            if (of[l].judged == 0) continue;
            std::printf("    %-42s %12llu judged %8llu broken, worst %.3g", name_of(law::name(l)),
                        static_cast<unsigned long long>(of[l].judged), static_cast<unsigned long long>(of[l].broken),
                        of[l].worst);
            for (int in = 0; in < states; ++in)
                if (of[l].broken_in[in] > 0)
                    std::printf(" %s %llu", name_of(state(in)), static_cast<unsigned long long>(of[l].broken_in[in]));
            std::printf("\n");
        }
    }
};

}  // namespace certificates_laws
}  // namespace
