C     SPDX-License-Identifier: LGPL-2.1-or-later
C
C     Hooke's law in increments, which asks the routines of Abaqus about its stress.
C     PROPS: Young's modulus, Poisson's ratio, and two stresses: q beyond the first one
C     is a warning, beyond the second one calls XIT, and STDB_ABQERR with -3 if it is
C     negative. It stops after 7 ms if the second one is zero.
C     STATEV: the invariants of SINV; the principal values of SPRINC; the largest
C     differences of sum PS AN AN (SPRIND) from the stress, of AN S AN^T (ROTSIG) from
C     PS, and of the strain that ROTSIG turns there and back.
      SUBROUTINE UMAT(STRESS,STATEV,DDSDDE,SSE,SPD,SCD,
     1 RPL,DDSDDT,DRPLDE,DRPLDT,
     2 STRAN,DSTRAN,TIME,DTIME,TEMP,DTEMP,PREDEF,DPRED,CMNAME,
     3 NDI,NSHR,NTENS,NSTATV,PROPS,NPROPS,COORDS,DROT,PNEWDT,
     4 CELENT,DFGRD0,DFGRD1,NOEL,NPT,LAYER,KSPT,KSTEP,KINC)
      INCLUDE 'ABA_PARAM.INC'
      CHARACTER*80 CMNAME
      DIMENSION STRESS(NTENS),STATEV(NSTATV),DDSDDE(NTENS,NTENS),
     1 DDSDDT(NTENS),DRPLDE(NTENS),STRAN(NTENS),DSTRAN(NTENS),
     2 TIME(2),PREDEF(1),DPRED(1),PROPS(NPROPS),COORDS(3),
     3 DROT(3,3),DFGRD0(3,3),DFGRD1(3,3)
      DIMENSION PS(3),AN(3,3),BACK(3,3),TURNED(6),IROW(6),ICOL(6)
      DIMENSION INTV(1),REALV(2)
      CHARACTER*8 CHARV(1)
      DATA IROW /1,2,3,1,1,2/, ICOL /1,2,3,2,3,3/
      G = PROPS(1)/2.D0/(1.D0+PROPS(2))
      XLAM = 2.D0*G*PROPS(2)/(1.D0-2.D0*PROPS(2))
      DO I = 1,NTENS
        DO J = 1,NTENS
          DDSDDE(I,J) = 0.D0
          IF (I.LE.NDI .AND. J.LE.NDI) DDSDDE(I,J) = XLAM
          IF (I.EQ.J .AND. I.LE.NDI) DDSDDE(I,J) = XLAM+2.D0*G
          IF (I.EQ.J .AND. I.GT.NDI) DDSDDE(I,J) = G
        END DO
      END DO
      DO I = 1,NTENS
        DO J = 1,NTENS
          STRESS(I) = STRESS(I)+DDSDDE(I,J)*DSTRAN(J)
        END DO
      END DO
      CALL SINV(STRESS,STATEV(1),STATEV(2),NDI,NSHR)
      CALL SPRINC(STRESS,STATEV(3),1,NDI,NSHR)
      CALL SPRIND(STRESS,PS,AN,1,NDI,NSHR)
      STATEV(6) = 0.D0
      DO I = 1,NTENS
        X = STRESS(I)
        DO K = 1,3
          X = X-PS(K)*AN(K,IROW(I))*AN(K,ICOL(I))
        END DO
        STATEV(6) = MAX(STATEV(6),ABS(X))
      END DO
      CALL ROTSIG(STRESS,AN,TURNED,1,NDI,NSHR)
      STATEV(7) = 0.D0
      DO I = 1,NTENS
        X = TURNED(I)
        IF (I.LE.3) X = X-PS(I)
        STATEV(7) = MAX(STATEV(7),ABS(X))
      END DO
      BACK = TRANSPOSE(DROT)
      CALL ROTSIG(STRAN,DROT,TURNED,2,NDI,NSHR)
      CALL ROTSIG(TURNED,BACK,TURNED,2,NDI,NSHR)
      STATEV(8) = 0.D0
      DO I = 1,NTENS
        STATEV(8) = MAX(STATEV(8),ABS(TURNED(I)-STRAN(I)))
      END DO
      IF (STATEV(2).GT.PROPS(3)) THEN
        INTV(1) = KINC
        REALV(1) = PROPS(3)
        REALV(2) = PROPS(1)
        CHARV(1) = CMNAME(1:8)
        CALL STDB_ABQERR(-1,'q of %S is beyond %R in increment %I',
     1   INTV,REALV,CHARV)
      END IF
      IF (STATEV(2).GT.ABS(PROPS(4))) THEN
        IF (PROPS(4).LT.0.D0) THEN
          CALL STDB_ABQERR(-3,'no more than %R',INTV,PROPS(4),
     1     CHARV)
        END IF
        IF (PROPS(4).GT.0.D0) CALL XIT
        IF (TIME(2).GT.7.D-3) STOP 'no convergence'
      END IF
      END
