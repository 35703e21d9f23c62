#pragma once

#include <memory>
#include <optional>
#include <set>
#include <string>

#include "identify/inference/maximum/calibrate.h"
#include "identify/inference/posterior_row.h"
#include "identify/live/change_detector.h"
#include "identify/live/sensor_faults.h"
#include "identify/loading/loads.h"

namespace palpate::identify {

struct FilterOptions {
    double forgetting = 1;   // of what readings told, that the next reading leaves, (0, 1]; 1: nothing is forgotten
    double surprise = 1e-4;  // a reading less probable than that is held back, (0, 0.1]
    int particles = 200;     // of a cloud, >= 10
    std::uint64_t seed = 1;
    void validate() const;  // @throws InvalidInput naming option, value, bound
};

/// @throws InvalidInput where a reading depends on those before it, as the material remembers, or where tools and
/// actuators move the body.
void require_followable(const skeleton::Model& model, const MeasurementSet& set);

/// What became of a reading.
struct FilterUpdate {
    enum class Fate { taken_in, held_back, left_out };
    Fate fate = Fate::left_out;
    std::string why = {};        // it was left out, or what was mended, in words
    double p_value = missing;    // of so large an error of the forecast
    double error = missing;      // rms of the forecast [mm]
    int readings = 0;            // taken in so far
    int informed = 0;            // numbers that the measurements inform
    std::optional<Alarm> alarm;  // as long as the model does not fit
};

/// All that a filter knows; what a cloud file holds.
struct FilterState {
    Eigen::VectorXd v;  // the mean, in coordinates in which the prior is N(0, 1) (P)
    Spectrum spectrum;  // of what readings told, in these
    int readings = 0;
    std::set<StateName> seen;
    ChangeDetector change;
};

/// Stiffness while the body is being touched: a posterior that each reading changes, for a price that does not grow.
///
/// The posterior is N(v, (1 + A)^-1) with A, the information of all readings so far, held by its leading eigenpairs: a
/// sufficient statistic where errors go straight. A reading is forecast at the mean; with its slopes there the mean
/// takes Gauss-Newton steps, more than one where it goes far, and A grows by J^T J [Bell & Cathey 1993: an iterated
/// Kalman filter in the form of information]. Particles are drawn from the statistic, anew with every reading, so that
/// they neither degenerate nor thin out. As long as readings are few they are kept, and `rejuvenate` fits all of them
/// anew, which takes back what early slopes got wrong; later ones change the mean so little that slopes hold.
///
/// Forgetting counts each reading `forgetting` times as much as the next one, before that is forecast; so what is held
/// back is forgotten past as well, and a body that changed for good is learnt anew.
///
/// Surprise is the probability of an error at least as large as the forecast's, whitened by noise, model error and what
/// is not known yet. A reading below `surprise` is held back; several in a row raise an alarm (ChangeDetector).
class Filter {
public:
    /// From a calibration by readings of the same model, which are all that is known so far. `set`: markers, noise and
    /// supports; those of its states that were calibrated with count as seen.
    /// @throws InvalidInput as require_followable.
    Filter(const skeleton::Model& model, MeasurementSet set, Calibration calibration, const FilterOptions& options);

    FilterUpdate assimilate(const LoadState& reading);
    /// Fits all readings anew while they are kept; false where there is nothing to gain. Takes as long as a fit.
    bool rejuvenate(int threads);

    std::vector<PosteriorRow> posterior() const;
    /// Stiffnesses (particles x P), each as probable as the others.
    Eigen::MatrixXd particles() const;
    skeleton::Model model() const;  // with the stiffness at the mean

    const FilterState& state() const { return state_; }
    /// Goes on from there. @throws InvalidInput where it is of another number of parameters or markers.
    void resume(FilterState state);
    const Calibration& calibration() const { return calibration_; }
    const MeasurementSet& set() const { return set_; }

private:
    Eigen::VectorXd theta(const Eigen::VectorXd& v) const;
    int informed() const;

    skeleton::Model model_;
    MeasurementSet set_;
    Calibration calibration_;
    FilterOptions options_;
    std::vector<skeleton::Attachment> attachments_;
    std::unique_ptr<ContactLoads> loads_;
    bool always_loaded_;
    FilterState state_;
    std::vector<StateReadings> kept_;  // all readings, while they are few
    bool keeps_all_ = true;
    bool refitted_ = true;  // nothing was taken in since the last fit
    SensorFaults faults_;
};

}  // namespace palpate::identify
