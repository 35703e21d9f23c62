#pragma once

#include <optional>
#include <string>

#include "diagnosis/truth.h"
#include "identify/diagnosis/locate/missing_source.h"

namespace palpate::bench {

/// What a located source has right of what is hidden. What the truth does not tell, or has not got, is absent.
struct Located {
    bool kind = false;  // gravity, prestress and growth are forces in the body; contact, pressure, compliant supports
                        // and friction act at its boundary; faults of readings and gains are the sensors'; all others
                        // change its stiffness
    std::optional<bool> law;
    std::optional<double> place_mm, place_share;  // from the hidden part's centre; over the body's longest side
    std::optional<double> angle;                  // between the directions [degrees]
};

/// `size`: the body's longest side [mm]. Of several effects that are hidden, the first of the located kind counts.
Located judge_location(const Truth& truth, const identify::MissingSource& source, double size);

/// Over many sets.
class LocatedTally {
public:
    void add(const Truth& truth, const std::optional<identify::MissingSource>& source, double size);
    /// Held-out errors without and with what was located; not finite: it could not be added.
    void add_held_out(const Truth& truth, double before, double after);
    void add(const LocatedTally& more);
    /// In Markdown: shares of what is right, and what is located where nothing is hidden.
    void print() const;

private:
    struct Share {
        int right = 0, of = 0;
        void add(bool is_right) {
            right += is_right ? 1 : 0;
            ++of;
        }
        void add(const Share& more) {
            right += more.right;
            of += more.of;
        }
    };
    Share kind_, law_, place_, direction_, held_out_, nulls_;
};

}  // namespace palpate::bench
