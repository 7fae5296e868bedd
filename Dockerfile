# The image holds one static binary: no shell, no libraries. The binary does not run as root.
FROM rust:1.95-slim-bookworm AS builder
WORKDIR /build

# The flag links the C library into the binary, so that the image needs no C library. The builds below name
# their target. Cargo then keeps the flag away from build scripts and procedural macros, which must stay dynamic.
ENV RUSTFLAGS="-C target-feature=+crt-static"

# The dependencies have a layer of their own. It is built again only when a manifest or the lock file changes.
COPY Cargo.toml Cargo.lock ./
COPY src/core/Cargo.toml src/core/
COPY src/nc/Cargo.toml src/nc/
COPY src/part/Cargo.toml src/part/
COPY src/post/Cargo.toml src/post/
COPY src/plot/Cargo.toml src/plot/
COPY src/server/Cargo.toml src/server/
# Benchmarks are not built, but the manifest names them.
COPY benches benches
# Empty files stand for the other targets that the manifests name, so that Cargo builds the dependencies alone.
RUN mkdir -p tests/real/controller tests/real/programs tests/real/parts \
    && echo 'fn main() {}' > src/main.rs \
    && touch src/core/lib.rs src/nc/lib.rs src/part/lib.rs src/post/lib.rs src/plot/lib.rs src/server/lib.rs \
        tests/real/controller/main.rs tests/real/programs/main.rs tests/real/parts/figures.rs \
    && cargo build --release --locked --target "$(rustc --print host-tuple)" \
    && rm -r src benches

COPY . .
# The empty files are newer than the sources. Without `touch` Cargo would keep what it built from them.
RUN touch src/main.rs src/*/lib.rs \
    && cargo build --release --locked --target "$(rustc --print host-tuple)" \
    && mv target/*/release/toolpathd /toolpathd

FROM scratch
COPY --from=builder /toolpathd /toolpathd
# The service listens on all addresses of the container. Publishing the port decides who reaches the service.
ENV TOOLPATHD_LISTEN=0.0.0.0:8080 \
    TOOLPATHD_ALLOW_PUBLIC=true \
    TOOLPATHD_LOG_FORMAT=json
EXPOSE 8080
HEALTHCHECK --interval=10s --timeout=4s CMD ["/toolpathd", "healthcheck"]
USER 65532:65532
ENTRYPOINT ["/toolpathd"]
