# A static binary alone in an image: no shell, no libraries, no root.
FROM rust:1.95-slim-bookworm AS builder
WORKDIR /build

# The C library is linked in, so that the image needs none. An explicit target keeps the flag away from
# build scripts and procedural macros, which must stay dynamic.
ENV RUSTFLAGS="-C target-feature=+crt-static"

# The dependencies are a layer of their own: they are built again only when the manifest changes.
COPY Cargo.toml Cargo.lock ./
# Cargo wants a file for every target that the manifest names.
RUN mkdir -p src benches tests/real/controller tests/real/overload \
    && echo 'fn main() {}' > src/main.rs \
    && touch src/lib.rs benches/arc_fitting.rs benches/interpolation.rs benches/plot.rs benches/programs.rs \
        benches/surface_milling.rs tests/real/controller/main.rs tests/real/overload/main.rs \
    && cargo build --release --locked --target "$(rustc --print host-tuple)" \
    && rm -r src benches

COPY . .
# The placeholders above are newer than the sources; without this cargo would keep them.
RUN touch src/main.rs src/lib.rs \
    && cargo build --release --locked --target "$(rustc --print host-tuple)" \
    && mv target/*/release/toolpathd /toolpathd

FROM scratch
COPY --from=builder /toolpathd /toolpathd
# Whoever publishes the port decides who reaches it.
ENV TOOLPATHD_LISTEN=0.0.0.0:8080 \
    TOOLPATHD_ALLOW_PUBLIC=true \
    TOOLPATHD_LOG_FORMAT=json
EXPOSE 8080
HEALTHCHECK --interval=10s --timeout=4s CMD ["/toolpathd", "healthcheck"]
USER 65532:65532
ENTRYPOINT ["/toolpathd"]
