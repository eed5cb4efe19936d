C     SPDX-License-Identifier: LGPL-2.1-or-later
C
C     Hencky's law from the deformation gradient, as 'linear-elastic':
C     tau = lambda tr(eps) 1 + 2 G eps, eps = ln(F F^T)/2.
C     PROPS: Young's modulus and Poisson's ratio. No STATEV.
      SUBROUTINE UMAT(STRESS, STATEV, DDSDDE, SSE, SPD, SCD, RPL,
     1 DDSDDT, DRPLDE, DRPLDT, STRAN, DSTRAN, TIME, DTIME, TEMP, DTEMP,
     2 PREDEF, DPRED, CMNAME, NDI, NSHR, NTENS, NSTATV, PROPS, NPROPS,
     3 COORDS, DROT, PNEWDT, CELENT, DFGRD0, DFGRD1, NOEL, NPT, LAYER,
     4 KSPT, JSTEP, KINC)
      INCLUDE 'ABA_PARAM.INC'
      CHARACTER*80 CMNAME
      DIMENSION STRESS(NTENS), STATEV(NSTATV), DDSDDE(NTENS,NTENS),
     1 DDSDDT(NTENS), DRPLDE(NTENS), STRAN(NTENS), DSTRAN(NTENS),
     2 TIME(2), PREDEF(1), DPRED(1), PROPS(NPROPS), COORDS(3),
     3 DROT(3,3), DFGRD0(3,3), DFGRD1(3,3), JSTEP(4)
      DIMENSION B(3,3), W(3), V(3,3), EPS(3), TAU(3), D(3,3), AI(3,3)
      G = PROPS(1)/(2D0*(1D0 + PROPS(2)))
      ALAM = 2D0*G*PROPS(2)/(1D0 - 2D0*PROPS(2))
      CALL INVERT(DFGRD1, DET, AI)
      B = MATMUL(DFGRD1, TRANSPOSE(DFGRD1))
      CALL EIGEN(B, W, V)
      EPS = 0.5D0*LOG(W)
      TR  = EPS(1) + EPS(2) + EPS(3)
      TAU = ALAM*TR + 2D0*G*EPS
      D   = ALAM
      DO I = 1, 3
        D(I,I) = ALAM + 2D0*G
      END DO
      CALL SPATIAL(TAU, EPS, D, 1D0, G, V, DET, NTENS, STRESS, DDSDDE)
      SSE = (0.5D0*ALAM*TR*TR + G*DOT_PRODUCT(EPS, EPS))/DET
      END

      INCLUDE 'hencky.inc'
