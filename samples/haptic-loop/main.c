/* Prints what a hand feels that drags a model's skin in and out for a second, at 1 kHz.
 *
 *   cmake --build build --target haptic_loop
 *   build/haptic_loop runs/organ/identify/model.json 0 0 40  0 0 -8 > felt.csv
 *
 * The model, a point near its skin and the way of the hand from there [mm]. Seen: time [s] and force [N], which rises
 * and falls with the hand, smoothly, and lags behind it a little, as the body is damped. */
#include <stdio.h>
#include <stdlib.h>

#include "haptic_loop.h"
#include "skeleton/runtime/palpate_runtime.h"

int main(int argc, char** argv) {
    static double felt[1000][3];
    double numbers[6];
    if (argc != 8) {
        fprintf(stderr, "haptic_loop MODEL X Y Z  DX DY DZ\n");
        return 2;
    }
    for (int i = 0; i < 6; ++i) numbers[i] = atof(argv[i + 2]);
    const int status = haptic_loop(argv[1], numbers, numbers + 3, 1000, 1000, felt);
    if (status != PALPATE_OK) {
        fprintf(stderr, "haptic_loop: %s\n", palpate_message());
        return status;
    }
    puts("time,fx,fy,fz");
    for (int i = 0; i < 1000; ++i) printf("%.3f,%.6g,%.6g,%.6g\n", 0.001 * i, felt[i][0], felt[i][1], felt[i][2]);
    return 0;
}
