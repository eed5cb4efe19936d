# Greville on Debian, by its Debian package:
#   docker build -t greville .    # Debian 12; 13: --build-arg DEBIAN=trixie
#   run="docker run --rm --user $(id -u):$(id -g) -v $PWD:/work greville"
#   $run greville --new slope
#   $run greville slope.prm
#   $run greville-picture output/slope
# With Apptainer, on a cluster:
#   apptainer build greville.sif docker-daemon://greville:latest
#   apptainer exec greville.sif greville slope.prm
ARG DEBIAN=bookworm
FROM debian:${DEBIAN} AS build
COPY . /greville
RUN cd /greville && scripts/package

FROM debian:${DEBIAN}-slim
COPY --from=build /greville/build-package/greville_*.deb /tmp/
# Compilers for UMATs.
RUN apt-get update && DEBIAN_FRONTEND=noninteractive apt-get install -y --no-install-recommends \
      /tmp/greville_*.deb python3-yaml gfortran gcc libc6-dev && \
    rm -rf /tmp/greville_*.deb /var/lib/apt/lists/*
# Without --user the user is root. One thread per process is what pays. A user
# without a home has no other place for what matplotlib keeps.
ENV OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 OMP_NUM_THREADS=1 DEAL_II_NUM_THREADS=1 MPLCONFIGDIR=/tmp/matplotlib
WORKDIR /work
CMD ["greville", "--help"]
