/* A haptic loop in C: where the hand is goes in, what it feels comes out. See main.c for how to run it. */
#include "haptic_loop.h"

#include <math.h>

#include "skeleton/runtime/palpate_runtime.h"

int haptic_loop(const char* model, const double start[3], const double way[3], double rate, int ticks,
                double (*felt)[3]) {
    palpate_body* body;
    int contact = 0, status = palpate_open(model, 1, &body);
    double held[3];
    if (status == PALPATE_OK) status = palpate_touch(body, start, 2, &contact);
    if (status == PALPATE_OK) status = palpate_contact(body, contact, 0, held);
    for (int tick = 0; status == PALPATE_OK && tick < ticks; ++tick) {
        const double share = 0.5 - 0.5 * cos(4 * 3.14159265358979 * tick / rate); /* of the way, in and out */
        const double hand[3] = {held[0] + share * way[0], held[1] + share * way[1], held[2] + share * way[2]};
        status = palpate_drag(body, contact, hand, 0.5);
        if (status == PALPATE_OK) status = palpate_step_implicit(body, 1 / rate);
        if (status == PALPATE_OK) status = palpate_contact(body, contact, felt[tick], 0);
        for (int c = 0; c < 3; ++c) felt[tick][c] = 0 - felt[tick][c]; /* the hand feels what it does, turned round */
    }
    palpate_close(body);
    return status;
}
