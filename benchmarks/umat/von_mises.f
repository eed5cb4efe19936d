C     SPDX-License-Identifier: LGPL-2.1-or-later
C
C     Von Mises' yield condition with linear hardening, as 'von-mises':
C     b = f b_e f^T, eps = ln(b)/2, f(trial) = sqrt(3 J2) - (Y + H alpha),
C     a radial return in Kirchhoff stresses.
C     PROPS: Young's modulus, Poisson's ratio, Y, H.
C     STATEV: b_e - 1 (11, 22, 33, 12, 13, 23), alpha.
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
      DIMENSION F(3,3), AI(3,3), B(3,3), W(3), V(3,3), EPS(3), TAU(3),
     1 S(3), D(3,3), IROW(6), ICOL(6)
      DATA IROW /1, 2, 3, 1, 1, 2/, ICOL /1, 2, 3, 2, 3, 3/
      G = PROPS(1)/(2D0*(1D0 + PROPS(2)))
      ALAM = 2D0*G*PROPS(2)/(1D0 - 2D0*PROPS(2))
      BULK = ALAM + 2D0*G/3D0
      H    = PROPS(4)
      CALL INVERT(DFGRD0, DET, AI)
      F = MATMUL(DFGRD1, AI)
      CALL INVERT(DFGRD1, DET, AI)
      DO K = 1, 6
        B(IROW(K),ICOL(K)) = STATEV(K)
        B(ICOL(K),IROW(K)) = STATEV(K)
      END DO
      DO I = 1, 3
        B(I,I) = B(I,I) + 1D0
      END DO
      B = MATMUL(F, MATMUL(B, TRANSPOSE(F)))
      CALL EIGEN(B, W, V)
      EPS = 0.5D0*LOG(W)
      TR  = EPS(1) + EPS(2) + EPS(3)
      S   = 2D0*G*(EPS - TR/3D0)
      Q   = SQRT(1.5D0*DOT_PRODUCT(S, S))
      Y   = PROPS(3) + H*STATEV(7)
      GAMMA = 0D0
      RATIO = 1D0
      SLOPE = 0D0
      IF (Q .GT. Y) THEN
        GAMMA = (Q - Y)/(3D0*G + H)
        RATIO = (Y + H*GAMMA)/Q
        SLOPE = 9D0*G*G/(Q*Q)*(1D0/(3D0*G + H) - GAMMA/Q)
      END IF
      DO I = 1, 3
        DO J = 1, 3
          D(I,J) = BULK - 2D0*G*RATIO/3D0 - SLOPE*S(I)*S(J)
          IF (I .EQ. J) D(I,J) = D(I,J) + 2D0*G*RATIO
        END DO
      END DO
      TAU = BULK*TR + RATIO*S
      CALL SPATIAL(TAU, EPS, D, RATIO, G, V, DET, NTENS, STRESS, DDSDDE)
C     The elastic strain, and b_e - 1.
      EPS = TR/3D0 + RATIO*S/(2D0*G)
      STATEV(7) = STATEV(7) + GAMMA
      W = EXP(2D0*EPS) - 1D0
      DO K = 1, 6
        STATEV(K) = 0D0
        DO M = 1, 3
          STATEV(K) = STATEV(K) + W(M)*V(IROW(K),M)*V(ICOL(K),M)
        END DO
      END DO
      SSE = (0.5D0*ALAM*TR*TR + G*DOT_PRODUCT(EPS, EPS))/DET
      SPD = SPD + RATIO*Q*GAMMA/DET
      END

      INCLUDE 'hencky.inc'
