# Greville on Debian 12, by its Debian package:
#   docker build -t greville .
#   docker run --rm -v "$PWD:/work" greville greville slope.prm
# With Apptainer, on a cluster:
#   apptainer build greville.sif docker-daemon://greville:latest
#   apptainer exec greville.sif greville slope.prm
FROM debian:bookworm AS build
COPY . /greville
RUN cd /greville && scripts/package

FROM debian:bookworm-slim
COPY --from=build /greville/build-package/greville_*.deb /tmp/
# Compilers for UMATs.
RUN apt-get update && DEBIAN_FRONTEND=noninteractive apt-get install -y --no-install-recommends \
      /tmp/greville_*.deb python3-yaml gfortran gcc libc6-dev && \
    rm -rf /tmp/greville_*.deb /var/lib/apt/lists/*
# In a container the user is root, and one thread per process is what pays.
ENV OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 OMP_NUM_THREADS=1 DEAL_II_NUM_THREADS=1
WORKDIR /work
CMD ["greville", "--help"]
