#ifndef PALPATE_SAMPLE_HAPTIC_LOOP_H
#define PALPATE_SAMPLE_HAPTIC_LOOP_H

#ifdef __cplusplus
extern "C" {
#endif

/* Takes hold of a body's skin near `start` [mm] and drags it along `way` [mm] and back, over and over, twice a second,
 * at `rate` ticks a second. felt[i]: the force on the hand at tick i [N]. 0, or a palpate_status. */
int haptic_loop(const char* model, const double start[3], const double way[3], double rate, int ticks,
                double (*felt)[3]);

#ifdef __cplusplus
}
#endif

#endif
