#include "physics/element/reference.h"

#include <arkode/arkode_erkstep.h>
#include <fmt/format.h>
#include <nvector/nvector_serial.h>
#include <sundials/sundials_context.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "core/simulation/physics_module.h"

namespace sluice::element {

namespace {

/// Of the update that a rate is taken from: its strain, and its time over that of the stage at most.
constexpr double tiny_strain = 2e-9, tiny_share = 1e-6;

struct Rates {
  Tensor strain{}, stress{};
  double pore_pressure = 0;
  std::vector<double> state;
  Tensor now{};  ///< the stress itself, on the yield surface
};

/// The rate equations of a stage.
class RateEquations {
 public:
  RateEquations(const Stage& stage, const Material& material, const PointState& start)
      : stage_(stage),
        material_(material),
        targets_(stage, start),
        begin_(start.time),
        modulus_(stiffness_at(material, start.stress)),
        unknowns_(stage, modulus_),
        warm_(Vector::Zero(unknowns_.size())) {
    for (const double rate : stage.strain_rate) given_ = std::max(given_, std::abs(rate));
    for (const std::size_t k : unknowns_.stressed()) given_ = std::max(given_, std::abs(targets_.rate(k)) / modulus_);
    given_ = std::max(given_, 1e-9 / stage.duration);
  }

  /// The rates at `point`, whose time may be that of any part of the stage; false if no strain rate fits the stresses.
  bool evaluate(const PointState& point, Rates& rates) {
    const double size = std::max(given_, warm_.lpNorm<Eigen::Infinity>());
    const double dt = std::min(tiny_strain / size, tiny_share * stage_.duration);
    // Within a tiny strain of first yield the updates lie on different sides of it, and the rates are no rates; a
    // shorter or a longer update then sees one side.
    for (const auto& [start, share] : {std::pair{1.0, 1.0}, {0.0, 1.0}, {0.0, 1e-2}, {1.0, 1e2}}) {
      Vector x = start * warm_;
      if (!solve(point, size, share * dt, x, rates)) continue;
      warm_ = x;
      pore_pressure_ = unknowns_.pore_pressure(x);
      rates.pore_pressure = viscous() ? 0 : pore_pressure_;
      return true;
    }
    return false;
  }

  /// The point with its stress on the yield surface, and with viscous stress, for output.
  bool complete(PointState& point) {
    Rates rates;
    if (!evaluate(point, rates)) return false;
    point.stress = rates.now;
    if (viscous()) point.pore_pressure = pore_pressure_;
    return true;
  }

 private:
  /// Stress itself depends on the strain rate.
  bool viscous() const { return material_.viscosity() > 0; }

  /// How far total stress (of a viscous material) or its rate misses what is given.
  double miss(const PointState& point, const Rates& rates, double pore_pressure, std::size_t k) const {
    const double share = (point.time - begin_) / stage_.duration, pore = k < 3 ? pore_pressure : 0;
    if (viscous()) return rates.now[k] - pore - targets_.at(k, share);
    // What the error control let pass is led back within a twentieth of the stage.
    const double off = rates.now[k] - (k < 3 ? point.pore_pressure : 0) - targets_.at(k, share);
    return rates.stress[k] - pore - targets_.rate(k) + 20 * off / stage_.duration;
  }

  bool solve(const PointState& point, double size, double dt, Vector& x, Rates& rates) const {
    const auto residual = [&](const Vector& unknown) {
      const Tensor strain_rate = unknowns_.strain(unknown, 1);
      rates = from_update(point, strain_rate, dt);
      const double pore = unknowns_.pore_pressure(unknown);
      double scale = modulus_ * size;
      if (viscous()) {
        scale = 1e-9 * modulus_;
        for (const double s : rates.now) scale = std::max(scale, std::abs(s));
      }
      return unknowns_.residual([&](std::size_t k) { return miss(point, rates, pore, k); }, strain_rate, scale);
    };
    const NewtonOptions options{.perturbation = 1e-3 * size, .tolerance = 1e-9, .acceptable = 1e-5};
    const bool solved = newton(residual, x, options);
    residual(x);  // leaves `rates` at the solution
    rates.strain = unknowns_.strain(x, 1);
    return solved;
  }

  /// Three updates over `dt` one after the other; the third minus the second is the rate. The first sets right what is
  /// not on the yield surface, and what comes with the rate at once; the second what a law finds a step later, such as
  /// a strength that follows the plastic strain of the step before.
  Rates from_update(const PointState& point, const Tensor& strain_rate, double dt) const {
    Tensor strain;
    for (std::size_t k = 0; k < components; ++k) strain[k] = strain_rate[k] * dt;
    PointState first = point;
    for (int n = 0; n < 2; ++n) {
      update_point(material_, strain, dt, first);
      first.time += dt;
    }
    PointState second = first;
    update_point(material_, strain, dt, second);
    Rates rates;
    for (std::size_t k = 0; k < components; ++k) {
      rates.stress[k] = (second.stress[k] - first.stress[k]) / dt;
      rates.now[k] = 3 * first.stress[k] - 2 * second.stress[k];
    }
    for (std::size_t k = 0; k < point.state.size(); ++k) rates.state.push_back((second.state[k] - first.state[k]) / dt);
    return rates;
  }

  const Stage& stage_;
  const Material& material_;
  Targets targets_;
  double begin_, modulus_;
  double given_ = 0;  ///< size of the given rates [1/s]
  Unknowns unknowns_;
  Vector warm_;               ///< unknown rates found last
  double pore_pressure_ = 0;  ///< of a viscous material [Pa]
};

// ---- the point as a vector of ARKODE: strain, stress, pore pressure, state ----

std::size_t length(const PointState& point) { return 2 * components + 1 + point.state.size(); }

void pack(const Tensor& strain, const Tensor& stress, double pore_pressure, const std::vector<double>& state,
          N_Vector vector) {
  double* y = N_VGetArrayPointer(vector);
  y = std::ranges::copy(strain, y).out;
  y = std::ranges::copy(stress, y).out;
  *y++ = pore_pressure;
  std::ranges::copy(state, y);
}

void unpack(N_Vector vector, PointState& point) {
  const double* y = N_VGetArrayPointer(vector);
  std::copy_n(y, components, point.strain.begin());
  std::copy_n(y + components, components, point.stress.begin());
  point.pore_pressure = y[2 * components];
  std::copy_n(y + 2 * components + 1, point.state.size(), point.state.begin());
}

/// What ARKODE's right-hand side needs.
struct Problem {
  RateEquations& equations;
  PointState point;
};

int right_hand_side(double time, N_Vector y, N_Vector rate, void* data) {
  auto& problem = *static_cast<Problem*>(data);
  try {
    unpack(y, problem.point);
    problem.point.time = time;
    Rates rates;
    if (!problem.equations.evaluate(problem.point, rates)) return 1;  // ARKODE tries a shorter step
    pack(rates.strain, rates.stress, rates.pore_pressure, rates.state, rate);
    return 0;
  } catch (...) {
    return -1;  // no exception may pass through C
  }
}

/// Absolute tolerances: of stresses relative to the largest stress of the start, at least 1 kPa; of strains relative to
/// 1 %.
void set_absolute_tolerances(const Material& material, const PointState& start, double relative, N_Vector vector) {
  double stress = 1e3;
  for (const double s : start.stress) stress = std::max(stress, std::abs(s));
  Tensor strains, stresses;
  strains.fill(relative * 1e-2);
  stresses.fill(relative * stress);
  std::vector<double> state;
  for (const ColumnSpec& spec : material.columns())
    state.insert(state.end(), static_cast<std::size_t>(spec.components),
                 relative * (spec.unit == "Pa" ? stress : 1e-2));
  pack(strains, stresses, relative * stress, state, vector);
}

/// The objects of SUNDIALS, which are freed in the opposite order.
class Integrator {
 public:
  Integrator(Problem& problem, const Material& material, double tolerance, double longest) {
    require(SUNContext_Create(nullptr, &context_) == 0);
    const auto n = static_cast<sunindextype>(length(problem.point));
    y_ = N_VNew_Serial(n, context_);
    absolute_ = N_VNew_Serial(n, context_);
    require(y_ != nullptr && absolute_ != nullptr);
    const PointState& p = problem.point;
    pack(p.strain, p.stress, p.pore_pressure, p.state, y_);
    set_absolute_tolerances(material, p, tolerance, absolute_);
    memory_ = ERKStepCreate(right_hand_side, p.time, y_, context_);
    require(memory_ != nullptr);
    ERKStepSetUserData(memory_, &problem);
    ERKStepSVtolerances(memory_, tolerance, absolute_);
    ERKStepSetMaxNumSteps(memory_, 1'000'000);
    ERKStepSetMaxStep(memory_, longest);
    ERKStepSetErrHandlerFn(
        memory_, [](int, const char*, const char*, char*, void*) {}, nullptr);  // we report it
  }
  ~Integrator() {
    ERKStepFree(&memory_);
    N_VDestroy(absolute_);
    N_VDestroy(y_);
    SUNContext_Free(&context_);
  }
  Integrator(const Integrator&) = delete;
  Integrator& operator=(const Integrator&) = delete;

  /// Exactly to `time`; false if ARKODE gives up.
  bool advance(double time, PointState& point) {
    double reached = 0;
    ERKStepSetStopTime(memory_, time);
    if (ERKStepEvolve(memory_, time, y_, &reached, ARK_NORMAL) < 0) return false;
    unpack(y_, point);
    point.time = time;
    return true;
  }

 private:
  static void require(bool good) {
    if (!good) throw std::bad_alloc();
  }
  SUNContext context_ = nullptr;
  N_Vector y_ = nullptr, absolute_ = nullptr;
  void* memory_ = nullptr;
};

[[noreturn]] void refuse(const Stage& stage, double time) {
  throw PhysicsError(
      fmt::format("reference: {}: there is no solution beyond time {:g} s with this tolerance; "
                  "the strength may be reached",
                  stage.name, time));
}

}  // namespace

void integrate_reference(const ElementCase& definition, const Material& material,
                         const std::function<void(const Row&)>& record) {
  Row row{0, initial_point(definition, material)};
  record(row);
  for (row.stage = 0; row.stage < definition.stages.size(); ++row.stage) {
    const Stage& stage = definition.stages[row.stage];
    const double begin = row.point.time;
    RateEquations equations(stage, material, row.point);
    Problem problem{equations, row.point};
    Integrator integrator(problem, material, definition.reference.tolerance, stage.duration / 20);
    for (const double share : row_shares(stage, definition.output.every)) {
      const double earlier = row.point.time;
      if (!integrator.advance(begin + share * stage.duration, row.point)) refuse(stage, earlier);
      Row shown = row;
      if (!equations.complete(shown.point)) refuse(stage, earlier);
      record(shown);
      if (share == 1) row = shown;  // the next stage begins on the yield surface
    }
  }
}

}  // namespace sluice::element
