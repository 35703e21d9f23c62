#include "identify/preflight/prospects/unshown.h"

#include <map>

namespace palpate::identify {

std::string why_unshown(const EffectHypothesis& effect) {
    if (effect.is_of_links()) return "it is of a skeleton's links alone, and no solid body has it";
    static const std::map<std::string, std::string> known{
        {"pressure", "the body has no closed cavity"},
        {"volume", "the set declares no Poisson's ratio that readings could contradict; the fit finds one"},
        {"viscosity", "no load is read at two times after it was put on"},
        {"plasticity", "no state without load follows a load on the same body"},
        {"damage", "no body bears less, or something else, after more: under first loads it is as stiff as any"},
        {"friction", "no tendon that is drawn in passes a point between its ends, where it could turn and rub"},
        {"compliant-support", "no loaded marker tells how stiff the body is as a whole"},
        {"force-gain", "fewer than two probes have forces of their own, and one gain is a stiffness"},
        {"clock", "no load changes from state to state of a probe"},
        {"slip", "no tool is moved"},
        {"actuation-gain", "no actuator acts, or its gain is the body's stiffness"}};
    const auto found = known.find(effect.name());
    return found != known.end() ? found->second
                                : "nothing in the set shows it; what would: " + effect.description().reveals;
}

}  // namespace palpate::identify
