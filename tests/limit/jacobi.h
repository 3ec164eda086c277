/* Eigenvalues of small dense symmetric matrices, the plain way. */
#ifndef DEMOCLES_TEST_JACOBI_H
#define DEMOCLES_TEST_JACOBI_H

/* a [n][n] is destroyed. Smallest and largest eigenvalue. */
void jacobi(double *a, int n, double *smallest, double *largest);

#endif
