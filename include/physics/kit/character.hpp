// A character: a shape that walks, steps, jumps and rides through a world by queries.
#pragma once

#include "physics/kit/character_settings.hpp"
#include "physics/shape/placed.hpp"
#include "physics/world/world.hpp"

PHYSICS_HPP_BEGIN

/// A character that moves as it is told: it slides along walls, climbs steps, keeps to slopes and stairs that it
/// descends, rides on what moves beneath it, pushes bodies, and gets out of what it is in. It has no body of its own:
/// for others to meet it, move a kinematic body along, and leave that out by the filter. Move it once a step, after
/// world.step(). It takes its contacts from collide_shape, so that its shape must be of the recipe's set; a chain or a
/// mesh that is one-sided stops it from the front alone. Errors: numbers out of range, ways that may lead beyond 1/16
/// of it (in float of its square root, in double of 1e75), and an up of another length than 1 are refused, and it stays
/// as it was. Cost of a move: 4 queries on flat ground, more at steps and in corners.
template <class World, class Shape = typename World::capsule>
class character {
    static constexpr int D = World::dimension;

public:
    using S = typename World::scalar;
    using vec = typename World::vec;
    using settings_type = character_settings<S, D>;
    using ground_type = character_ground<S, D>;

    /// Of a shape as capsule::upright() gives it, with its feet at a point, and a unit vector upwards.
    character(const placed_shape<Shape, D>& shape, vec feet, vec up, const settings_type& with = {}) {
        const char* f = "character";
        if (!check(shape.shape, f) || !check(with, f) || !detail::check_in_range(f, "feet", feet) ||
            !detail::check_finite(f, "up", up))
            return;
        if (const double size = detail::to_double(length(up)); !(size > 0.999 && size < 1.001)) {
            detail::refuse(f, "length of up", size, "it must be 1, to less than 0.001");
            return;
        }
        set_settings(with);
        shape_ = shape.shape;
        rotation_ = shape.rotation;
        up_ = up;
        below_ = with.skin - dot(rotation_ * support(shape_, inverse_rotate(rotation_, -up_)), up_);
        vec side;
        for (int i = 0; i < D; ++i) {
            vec axis;
            axis[i] = S(1);
            if (length(across(axis)) > length(side)) side = across(axis);
        }
        side = normalized(side);
        half_width_ = dot(rotation_ * support(shape_, inverse_rotate(rotation_, side)), side);
        set_feet(feet);
    }

    [[nodiscard]] const settings_type& settings() const { return settings_; }
    void set_settings(const settings_type& with) {
        if (!check(with, "set_settings")) return;
        settings_ = with;
        settings_.filter.one_way = true;
    }

    /// Where its feet are: the lowest point, as it stands on what is below (m).
    [[nodiscard]] vec feet() const { return position_ - up_ * below_; }
    void set_feet(vec feet) {
        if (!detail::check_in_range("set_feet", "feet", feet)) return;
        position_ = feet + up_ * below_;
        ground_ = {};
    }
    /// Its pose, to draw it, or to move a body of its own to it.
    [[nodiscard]] typename World::transform pose() const { return {position_, rotation_}; }
    /// How fast it has moved by itself in the last move, without what carried it or pushed it out (m/s).
    [[nodiscard]] vec velocity() const { return velocity_; }
    /// Throws it, or lets it fall as fast as that: what it does not do by walking (m/s).
    void set_fall_velocity(vec v) {
        if (!detail::check_in_range("set_fall_velocity", "v", v)) return;
        fall_ = v;
        ground_ = {};
    }
    /// What it stands on, if anything.
    [[nodiscard]] const ground_type& ground() const { return ground_; }
    /// Whether the last move found no way out of what it is in.
    [[nodiscard]] bool is_stuck() const { return is_stuck_; }
    /// Leaves the ground with the next move, as fast as that above what it stands on (m/s).
    void jump(S speed) {
        if (detail::check_not_negative("jump", "speed", speed) && detail::check_in_range("jump", "speed", speed))
            jump_ = speed;
    }

    /// Moves it by dt seconds. It walks by a velocity (m/s) across up: along the ground where it stands on any, and
    /// falls otherwise.
    void move(World& w, vec walk, S dt) {
        if (!detail::check_in_range("move", "walk", walk) || !detail::check_positive("move", "dt", dt)) return;
        detail::scoped([&] {
            if (!check_reach(w, walk, dt)) return;
            // What is refused on the way leaves it where it is.
            character next = *this;
            next.move_by(w, across(walk), dt);
            *this = next;
        });
    }

private:
    using contact = typename World::shape_contact;
    /// Neither how fast nor how far it gets may leave the range of numbers.
    [[nodiscard]] bool check_reach(const World& w, const vec& walk, S dt) const {
        const auto size = [](S x) { return detail::to_double(abs(x)); };
        const vec gravity = w.settings().gravity;
        const double h = size(dt);
        double speed = size(jump_), reach = 0;
        for (int i = 0; i < D; ++i) {
            speed += size(walk[i]) + size(fall_[i]) + size(ground_.velocity[i]) + size(gravity[i]) * h;
            reach = max(reach, size(position_[i]));
        }
        reach += speed * max(h, 1.0);
        // Of floating point the squares too.
        const double range = detail::to_double(scalar_traits<S>::max()),
                     limit = detail::is_fixed<S> ? range : min(sqrt(range), detail::largest_of_double);
        return reach <= limit / 16 ||
               detail::refuse("move", "reach", reach,
                              "it must stay well within the scalar's range, and so must its square");
    }
    /// How fast it gets out of what it is in (m/s).
    static constexpr S fastest_out = S(12);

    [[nodiscard]] vec across(const vec& v) const { return v - up_ * dot(v, up_); }
    [[nodiscard]] bool is_walkable(const vec& normal) const { return dot(normal, up_) >= cos_max_; }
    /// As fast as v, along a slope.
    [[nodiscard]] vec along(const vec& v, const vec& normal) const {
        const S size = length(v);
        if (!(size > S(0)) || !is_walkable(normal)) return v;
        return normalized(v - up_ * (dot(v, normal) / dot(normal, up_))) * size;
    }
    [[nodiscard]] auto cast(const World& w, const vec& from, const vec& translation) const {
        return w.cast_shape(shape_, {from, rotation_}, translation, settings_.filter);
    }
    /// How far it goes along a unit direction, up to a distance, so that it keeps its skin from what it meets.
    S free_way(const World& w, const vec& from, const vec& direction, S distance,
               typename World::world_hit& hit) const {
        constexpr double flattest = 1.0 / 8;
        const S reach = distance + settings_.skin * S(1 / flattest);
        hit = cast(w, from, direction * reach);
        if (!hit) return distance;
        const S into = max(-dot(hit.normal, direction), S(flattest));
        return clamp(hit.fraction * reach - settings_.skin / into, S(0), distance);
    }

    void move_by(World& w, const vec& walk, S dt) {
        cos_max_ = cos(settings_.max_slope) - S(1.0 / 1024);
        last_push_ = std::exchange(push_, {});
        ride(w);
        push_out(w, dt);
        if (is_in_) {
            // It neither walks nor falls before it is out.
            velocity_ = fall_ = {};
            return;
        }
        const bool jumps = jump_ > S(0) && ground_;
        if (jumps) {
            fall_ = ground_.velocity + up_ * jump_;
            ground_ = {};
        }
        jump_ = S(0);
        const bool stood = static_cast<bool>(ground_);
        const vec start = position_, toward = normalized(walk);
        if (stood) {
            // It waits where a step has taken it ahead.
            const S far = length(walk) * dt, waits = min(ahead_, far);
            ahead_ -= waits;
            slide(w, along(toward * (far - waits), ground_.normal), true, dt);
            fall_ = {};
        } else {
            ahead_ = S(0);
            slide(w, walk * dt, true, dt);
        }
        const vec walked = position_ - start;
        S rounding{};
        if (!stood) {
            if (!jumps) fall_ += w.settings().gravity * dt;
            // What stops it leaves it as fast as that, by rounding.
            rounding = S(64) * scalar_traits<S>::epsilon() * (S(1) + length(fall_));
            slide(w, fall_ * dt, false, dt);
        }
        velocity_ = walked / dt + fall_;
        find_ground(w, toward, stood, rounding);
        if (!ground_) return;
        velocity_ -= fall_;
        fall_ = {};
        if (w.type(ground_.body) == body_type::dynamic_body && settings_.mass > S(0))
            w.apply_force_at(ground_.body, w.settings().gravity * settings_.mass, ground_.point);
    }

    /// What it stands on takes it along.
    void ride(World& w) {
        if (!ground_) return;
        if (!w.contains(ground_.body) || !w.enabled(ground_.body)) {
            ground_ = {};
            return;
        }
        const vec now = w.pose(ground_.body) * local_point_;
        position_ += now - ground_.point;
        ground_.point = now;
        ground_.velocity = w.velocity_at(ground_.body, now);
    }

    /// Out of what it overlaps, and away to the skin's distance, by a limited way.
    void push_out(World& w, S dt) {
        is_stuck_ = is_in_ = false;
        S limit = fastest_out * dt;
        for (int pass = 0; pass < 4; ++pass) {
            contact found[16];
            int count = 0;
            w.collide_shape(shape_, {position_, rotation_}, settings_.skin, settings_.filter, [&](const contact& c) {
                if (c.separation() < settings_.skin * S(0.875)) found[count++] = c;
                return count < 16;
            });
            if (count == 0) return;
            vec by;
            for (int round = 0; round < 8; ++round)
                for (int i = 0; i < count; ++i) {
                    const S rest = settings_.skin - found[i].separation() - dot(by, found[i].normal);
                    if (rest > S(0)) by += found[i].normal * rest;
                }
            S left = S(0);
            for (int i = 0; i < count; ++i) left = max(left, -found[i].separation() - dot(by, found[i].normal));
            // Wedged: no way leads out of all.
            if (left > settings_.skin) {
                is_stuck_ = is_in_ = true;
                return;
            }
            const S size = length(by);
            if (!(size < limit)) {
                position_ += by * (limit / size);
                is_in_ = true;
                return;
            }
            position_ += by;
            limit -= size;
        }
    }

    /// Moves along a way, and along what is in it. Walking, it takes what is too steep for a wall, and climbs steps.
    void slide(World& w, vec rest, bool walks, S dt) {
        const vec aim = rest;
        vec walls[2];
        int count = 0;
        for (int k = 0; k < 5; ++k) {
            const S distance = length(rest);
            if (!(distance > settings_.skin * S(1.0 / 1024))) return;
            const vec direction = rest / distance;
            typename World::world_hit hit;
            const S free = free_way(w, position_, direction, distance, hit);
            position_ += direction * free;
            if (!(free < distance)) return;
            rest = direction * (distance - free);
            vec normal = hit.normal;
            if (walks) {
                push(w, hit, aim, dt);
                if (!is_walkable(normal)) {
                    if (ground_ && climb(w, across(rest), distance - free)) return;
                    if (!(largest(across(normal)) > S(1.0 / 256))) return;
                    normal = normalized(across(normal));
                } else if (count == 0) {
                    rest = along(across(rest), normal);
                    if (dot(rest, normal) > S(-1e-3) * distance) continue;
                }
            } else {
                fall_ -= normal * min(dot(fall_, normal), S(0));
            }
            rest -= normal * min(dot(rest, normal), S(0));
            for (int i = 0; i < count; ++i)
                if (dot(rest, walls[i]) < S(0)) {
                    // Into a corner: along its crease, if there is one.
                    if constexpr (D == 3) {
                        const vec crease = normalized(cross(normal, walls[i]));
                        rest = crease * dot(rest, crease);
                    } else {
                        return;
                    }
                }
            if (dot(rest, aim) < S(0)) return;
            if (count < 2) walls[count++] = normal;
        }
    }

    /// What it walks against gets as fast as it, if it is strong enough. What held that back in the last step it is
    /// taken to be held back by in the next one.
    void push(World& w, const typename World::world_hit& hit, const vec& aim, S dt) {
        // Once a move: forces add up.
        if (push_.body || w.type(hit.body) != body_type::dynamic_body || !(settings_.strength > S(0))) return;
        const vec direction = normalized(across(-hit.normal));
        const S mass = w.mass(hit.body).mass, speed = dot(w.linear_velocity(hit.body), direction);
        const S missing = dot(aim, direction) / dt - speed;
        if (!(missing > S(0))) return;
        S held = S(0);
        if (hit.body == last_push_.body) held = max(last_push_.force - mass * (speed - last_push_.speed) / dt, S(0));
        const S force = min(settings_.strength, mass * missing / dt + held);
        push_ = {hit.body, force, speed};
        w.apply_force(hit.body, direction * force);
    }

    /// Up, on and down again, where that leads onto something that it can stand on.
    bool climb(const World& w, const vec& toward, S distance) {
        if (!(settings_.step_height > S(0)) || !(largest(toward) > S(0))) return false;
        const vec direction = normalized(toward);
        // How deep a tread must be.
        const S tread = max(settings_.skin, half_width_ * S(0.25));
        typename World::world_hit hit;
        const S lift = free_way(w, position_, up_, settings_.step_height + settings_.skin, hit);
        const vec raised = position_ + up_ * lift;
        if (free_way(w, raised, direction, max(distance, tread), hit) < max(distance, tread)) return false;
        // Whether there is a tread.
        const auto lands = [&](S far, vec& at) {
            const vec from = raised + direction * far;
            const S down = free_way(w, from, -up_, lift, hit);
            at = from - up_ * down;
            if (!hit || !(lift - down > settings_.skin * S(0.125))) return false;
            return dot(hit.point - feet(), up_) <= settings_.step_height + settings_.skin * S(0.25) &&
                   (is_walkable(hit.normal) || is_walkable(face_at(w, hit)));
        };
        vec at;
        if (!lands(max(distance, tread), at)) return false;
        // As far as it goes, if that reaches the tread.
        for (const S far : {distance, distance + settings_.skin * S(2), max(distance, tread)})
            if (lands(far, at)) {
                ahead_ += far - distance;
                position_ = at;
                return true;
            }
        return false;
    }

    /// The normal of the surface beside an edge that it touches; null if there is none.
    [[nodiscard]] vec face_at(const World& w, const typename World::world_hit& hit) const {
        const vec aside = across(hit.normal);
        const vec within = largest(aside) > S(1.0 / 256) ? normalized(aside) * settings_.skin : vec{};
        const S high = settings_.skin * S(2);
        const auto face = w.cast_ray(hit.point - within + up_ * high, up_ * (-high - high), settings_.filter);
        return face && !face.inside() ? face.normal : vec{};
    }

    /// What is below, within reach of its feet: it settles on that, unless it flies away from it faster than rounding.
    void find_ground(World& w, const vec& toward, bool stood, S rounding) {
        ground_ = {};
        const S skin = settings_.skin, reach = stood ? settings_.snap_distance + skin : skin * S(0.125);
        typename World::world_hit hit;
        // From a little above, since it may be nearer than its skin.
        const S free = free_way(w, position_ + up_ * skin, -up_, reach + skin, hit), down = free - skin;
        if (!hit || !(free < reach + skin)) return;
        const vec face = face_at(w, hit);
        const bool on_face = is_walkable(face);
        // One that climbs a step stands on its edge; one that falls by an edge does not, unless that is below its foot.
        const bool is_firm = is_walkable(hit.normal) ||
                             (on_face && dot(hit.normal, toward) < S(0) && (stood || dot(hit.normal, up_) > S(0.5)));
        const bool at_edge = largest(across(hit.normal)) > S(1.0 / 16);
        ground_type found{hit.shape, hit.body, hit.point, on_face ? face : hit.normal, {}};
        if (!is_firm || (down > skin && at_edge)) {
            // It does not lean over an edge, unless there is ground below its middle.
            const S below = below_ + down + (stood ? settings_.snap_distance : S(0)) + skin;
            const auto middle = w.cast_ray(position_, up_ * -below, settings_.filter);
            if (!middle || middle.inside() || !is_walkable(middle.normal)) return;
            if (!is_firm) found = {middle.shape, middle.body, middle.point, middle.normal, {}};
        }
        found.velocity = w.velocity_at(found.body, found.point);
        if (!stood && dot(fall_ - found.velocity, found.normal) > rounding) return;
        // What it touches aside lifts it no farther.
        position_ -= up_ * (is_firm ? down : max(down, S(0)));
        ground_ = found;
        local_point_ = inverse_rotate(w.rotation(found.body), found.point - w.position(found.body));
    }

    settings_type settings_;
    Shape shape_;
    typename World::rotation_type rotation_;
    vec up_, position_, velocity_, fall_, local_point_;
    ground_type ground_;
    /// How far its feet are below its origin.
    S below_{};
    /// How far it reaches aside (m).
    S half_width_{};
    S jump_{}, cos_max_{};
    /// How far steps have taken it ahead of where it would be by its speed (m).
    S ahead_{};
    /// What it pushed in this move and in the last one, how hard (N) and as fast as that was (m/s).
    struct pushed {
        body_id body;
        S force{}, speed{};
    };
    pushed push_, last_push_;
    /// Whether it is still in something, and whether it knows no way out.
    bool is_in_ = false, is_stuck_ = false;
};

PHYSICS_HPP_END
