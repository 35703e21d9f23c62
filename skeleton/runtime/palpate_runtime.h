/* A calibrated model, alive, for programs in C and whatever speaks to C. Units: mm, N, s, tonne. Spheres, vertices and
 * triangles are numbered as in the model's file. What body.h says of each holds here. A body is for one thread at a
 * time. Stepping, equilibria and what is done at contacts allocate nothing, but for palpate_touch and tools that touch
 * more of the body than before. */
#ifndef PALPATE_RUNTIME_H
#define PALPATE_RUNTIME_H

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

#if defined(__GNUC__)
#define PALPATE_API __attribute__((visibility("default")))
#else
#define PALPATE_API
#endif

/* NOLINTBEGIN(readability-identifier-naming, modernize-*): names and types as C has them */

typedef struct palpate_body palpate_body;

typedef enum palpate_status {
    PALPATE_OK = 0,
    PALPATE_INTERNAL = 1,   /* a fault of ours */
    PALPATE_BAD_INPUT = 3,  /* what you can mend: palpate_message() says what, which value, what is allowed */
    PALPATE_NO_SOLUTION = 4 /* the numbers came to no end; the body stays as it was */
} palpate_status;

/* What went wrong last in this thread; "" before anything did. Valid until the next call of this thread. */
PALPATE_API const char* palpate_message(void);

/* Reads model.json; *body is NULL unless the result is PALPATE_OK. `contacts`: most at a time, 0 to 64. */
PALPATE_API palpate_status palpate_open(const char* model, int contacts, palpate_body** body);
PALPATE_API void palpate_close(palpate_body* body); /* NULL is allowed */

/* What of the model is not played as it stands: notice i in words, NULL beyond the last. */
PALPATE_API const char* palpate_notice(const palpate_body* body, int i);

PALPATE_API int palpate_sphere_count(const palpate_body* body);
PALPATE_API int palpate_link_count(const palpate_body* body);
PALPATE_API int palpate_vertex_count(const palpate_body* body);
PALPATE_API int palpate_triangle_count(const palpate_body* body);
/* Three corners a triangle, counter-clockwise seen from outside; as long as the body lives. */
PALPATE_API const int* palpate_triangles(const palpate_body* body);

PALPATE_API palpate_status palpate_reset(palpate_body* body);
/* x, y, z of each vertex [mm] as the skin stands; overwritten by the next call. */
PALPATE_API palpate_status palpate_skin(palpate_body* body, const float** positions);
/* Centre [mm] and rotation from rest, a unit quaternion x, y, z, w. */
PALPATE_API palpate_status palpate_sphere(const palpate_body* body, int sphere, double position[3],
                                          double orientation[4]);

PALPATE_API palpate_status palpate_set_gravity(palpate_body* body, const double g[3]);
/* alpha [1/s], beta [s], in place of the model's own or, where it has none, of a ratio of 0.1 of the softest mode. */
PALPATE_API palpate_status palpate_set_damping(palpate_body* body, double alpha, double beta);

/* Takes hold of the skin nearest to a point [mm], over a radius (0: at the point). */
PALPATE_API palpate_status palpate_touch(palpate_body* body, const double point[3], double radius, int* contact);
PALPATE_API palpate_status palpate_release(palpate_body* body, int contact);
PALPATE_API palpate_status palpate_push(palpate_body* body, int contact, const double force[3]);
PALPATE_API palpate_status palpate_drag(palpate_body* body, int contact, const double to[3], double stiffness);
/* What acts on the body at a contact [N], and where the contact is [mm]; either may be NULL. */
PALPATE_API palpate_status palpate_contact(palpate_body* body, int contact, double force[3], double place[3]);

/* Rigid tools, which press on the skin without friction: a ball, or the flat face of a round punch that presses along
 * `axis` [mm]; away until it is placed. */
PALPATE_API palpate_status palpate_add_ball(palpate_body* body, double radius, int* tool);
PALPATE_API palpate_status palpate_add_punch(palpate_body* body, double radius, const double axis[3], int* tool);
/* `turn`: a unit quaternion x, y, z, w; NULL: not turned. By a quarter of its radius a step at most. */
PALPATE_API palpate_status palpate_place_tool(palpate_body* body, int tool, const double at[3], const double turn[4]);
PALPATE_API palpate_status palpate_lift_tool(palpate_body* body, int tool);
/* What it does to the body [N], and the moment of that about where it is [N mm]; either may be NULL. */
PALPATE_API palpate_status palpate_tool_load(palpate_body* body, int tool, double force[3], double moment[3]);

/* In the cavities that the skin encloses, beside the model's effects [MPa]. */
PALPATE_API palpate_status palpate_set_pressure(palpate_body* body, double pressure);
/* The cavity with a wall nearest to a point at rest, and the pressure in one. */
PALPATE_API palpate_status palpate_find_cavity(palpate_body* body, const double point[3], int* cavity);
PALPATE_API palpate_status palpate_set_cavity_pressure(palpate_body* body, int cavity, double pressure);
/* A cable through `points` points of the body, x, y, z each [mm]: the first is fixed in space, the last to the body. */
PALPATE_API palpate_status palpate_add_tendon(palpate_body* body, const double* path, int points, int* tendon);
PALPATE_API palpate_status palpate_pull_tendon(palpate_body* body, int tendon, double tension); /* [N] */
PALPATE_API palpate_status palpate_draw_tendon(palpate_body* body, int tendon, double length);  /* in, from rest [mm] */
PALPATE_API palpate_status palpate_let_tendon_go(palpate_body* body, int tendon);
PALPATE_API palpate_status palpate_tendon_tension(palpate_body* body, int tendon, double* tension); /* [N] */

PALPATE_API palpate_status palpate_stable_step(palpate_body* body, double* h);
PALPATE_API palpate_status palpate_step_explicit(palpate_body* body, double h, int steps);
PALPATE_API palpate_status palpate_step_implicit(palpate_body* body, double h);
PALPATE_API palpate_status palpate_equilibrium(palpate_body* body);
/* [N mm] */
PALPATE_API palpate_status palpate_energy(palpate_body* body, double* kinetic, double* potential);

/* NOLINTEND(readability-identifier-naming, modernize-*) */

#ifdef __cplusplus
}
#endif

#endif
