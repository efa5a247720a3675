/* Calibrations as functions to be minimized, for benchmarks of optimizers in any language.
 *
 * A problem is what an experiment of `kind: calibrate` minimizes, f(x) of d parameters in the units of
 * their names, with bounds, a start and, of a simulated string, the truth and the Cramer-Rao bound.
 * It does not change; its functions may be called from several threads.
 *
 *     modcal_problem* p = modcal_problem_open("calibrate.yaml", NULL, 0);
 *     if (!p) puts(modcal_problem_message());
 */
#ifndef MODCAL_PROBLEMS_H
#define MODCAL_PROBLEMS_H

#include <stddef.h>

#ifdef MODCAL_PROBLEMS_BUILT
#define MODCAL_PROBLEMS_API __attribute__((visibility("default")))
#else
#define MODCAL_PROBLEMS_API
#endif

#ifdef __cplusplus
extern "C" {
#endif

typedef struct modcal_problem modcal_problem;

/* Reads an experiment, makes or reads its records. assignments: "key=value", as --set takes them.
 * NULL where that cannot be done; modcal_problem_message() says why. */
MODCAL_PROBLEMS_API modcal_problem* modcal_problem_open(const char* file, const char* const* assignments,
                                    size_t assignment_count);
MODCAL_PROBLEMS_API void modcal_problem_close(modcal_problem* problem);

/* Why the last call of this thread failed, with place and remedy; "" where it did not. */
MODCAL_PROBLEMS_API const char* modcal_problem_message(void);

MODCAL_PROBLEMS_API size_t modcal_problem_dimension(const modcal_problem* problem);
/* "f0", "B", "x_c", "f_3", ... and SI units; they live as long as the problem. NULL: no such i. */
MODCAL_PROBLEMS_API const char* modcal_problem_name(const modcal_problem* problem, size_t i);
MODCAL_PROBLEMS_API const char* modcal_problem_unit(const modcal_problem* problem, size_t i);

/* Each writes d numbers. start: where a search begins; scale: a sensible step. */
MODCAL_PROBLEMS_API void modcal_problem_bounds(const modcal_problem* problem, double* lower, double* upper);
MODCAL_PROBLEMS_API void modcal_problem_start(const modcal_problem* problem, double* start);
MODCAL_PROBLEMS_API void modcal_problem_scale(const modcal_problem* problem, double* scale);

/* 0, or 1 where it is not known: of a record. */
MODCAL_PROBLEMS_API int modcal_problem_truth(const modcal_problem* problem, double* truth);
/* Standard deviations that no unbiased estimate from these records goes below, which knows nothing of
 * the force and, of a schedule of stages, the priors of the file: the Cramer-Rao bound at the truth,
 * whatever the objective. 0 where the records have no noise, infinity of what they do not tell;
 * 1 where there is none: of a record. */
MODCAL_PROBLEMS_API int modcal_problem_bound(const modcal_problem* problem, double* deviations);

/* f(x), and its slopes, by differences where the objective gives none. 0, or 1 where x is refused. */
MODCAL_PROBLEMS_API int modcal_problem_value(const modcal_problem* problem, const double* x, double* value);
MODCAL_PROBLEMS_API int modcal_problem_gradient(const modcal_problem* problem, const double* x, double* gradient);

#ifdef __cplusplus
}
#endif

#endif
