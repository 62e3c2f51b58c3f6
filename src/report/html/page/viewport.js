// The viewport: which part of the picture is seen, the same in every pane; pixels are squares, never smoothed.

const LARGEST_ZOOM = 64;
const GRID_FROM = 12;

class Viewport {
  /** `panes` holds the canvases; `changed` is told when zoom or position did. */
  constructor(panes, changed) {
    Object.assign(this, { panes, changed, zoom: 1, left: 0, top: 0, size: [1, 1], fitted: true });
  }

  /** The size of one pane on the screen, CSS pixels. */
  paneSize() {
    const pane = this.panes.querySelector("canvas");
    return pane ? [pane.clientWidth, pane.clientHeight] : [1, 1];
  }

  /** Shows the whole picture. */
  fit() {
    const [width, height] = this.paneSize();
    const zoom = Math.min(width / this.size[0], height / this.size[1]) || 1;
    // Enlarged by a whole factor, every pixel is the same square.
    this.zoom = zoom > 1 ? Math.floor(zoom) : zoom;
    this.left = (this.size[0] - width / this.zoom) / 2;
    this.top = (this.size[1] - height / this.zoom) / 2;
    this.fitted = true;
    this.changed();
  }

  /** Zooms around a point of a pane. */
  zoomBy(factor, [x, y]) {
    const zoom = Math.min(Math.max(this.zoom * factor, 0.05), LARGEST_ZOOM);
    this.left += x / this.zoom - x / zoom;
    this.top += y / this.zoom - y / zoom;
    Object.assign(this, { zoom, fitted: false });
    this.changed();
  }

  /** Moves by CSS pixels. */
  panBy(x, y) {
    this.left -= x / this.zoom;
    this.top -= y / this.zoom;
    this.fitted = false;
    this.changed();
  }

  /** The picture's pixel under a point of a pane; null outside. */
  pixelAt([x, y]) {
    const at = [Math.floor(this.left + x / this.zoom), Math.floor(this.top + y / this.zoom)];
    return at.every((value, axis) => value >= 0 && value < this.size[axis]) ? at : null;
  }

  /** Moves so far that a pixel is seen. */
  reveal([x, y]) {
    const [width, height] = this.paneSize().map(side => side / this.zoom);
    this.left = Math.min(Math.max(this.left, x + 1 - width), x);
    this.top = Math.min(Math.max(this.top, y + 1 - height), y);
  }

  /** Draws layers into a pane: the first to the left of `divider` (0 to 1), the second to the right of it. */
  draw(pane, [left, right], divider, marked) {
    const ratio = window.devicePixelRatio || 1;
    const [width, height] = [pane.clientWidth, pane.clientHeight];
    if (pane.width !== Math.round(width * ratio)) pane.width = Math.round(width * ratio);
    if (pane.height !== Math.round(height * ratio)) pane.height = Math.round(height * ratio);
    const context = pane.getContext("2d");
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.clearRect(0, 0, width, height);
    context.imageSmoothingEnabled = this.zoom < 1;
    const put = layer =>
      context.drawImage(layer, -this.left * this.zoom, -this.top * this.zoom, this.size[0] * this.zoom, this.size[1] * this.zoom);
    put(left);
    if (right) {
      context.save();
      context.beginPath();
      context.rect(divider * width, 0, width, height);
      context.clip();
      put(right);
      context.restore();
      context.fillStyle = "#fff";
      context.fillRect(divider * width - 1, 0, 2, height);
    }
    if (this.zoom >= GRID_FROM) this.drawGrid(context, width, height);
    if (marked) this.drawMark(context, marked);
  }

  drawGrid(context, width, height) {
    context.strokeStyle = "rgba(128, 128, 128, 0.35)";
    context.lineWidth = 1;
    context.beginPath();
    for (let x = Math.ceil(this.left); (x - this.left) * this.zoom < width; x++) {
      context.moveTo((x - this.left) * this.zoom, 0);
      context.lineTo((x - this.left) * this.zoom, height);
    }
    for (let y = Math.ceil(this.top); (y - this.top) * this.zoom < height; y++) {
      context.moveTo(0, (y - this.top) * this.zoom);
      context.lineTo(width, (y - this.top) * this.zoom);
    }
    context.stroke();
  }

  drawMark(context, [x, y]) {
    const side = Math.max(this.zoom, 5);
    const middle = [x, y].map((value, axis) => (value + 0.5 - (axis ? this.top : this.left)) * this.zoom);
    for (const [colour, grow] of [["#000", 2], ["#fff", 1]]) {
      context.strokeStyle = colour;
      context.lineWidth = 1;
      context.strokeRect(middle[0] - side / 2 - grow, middle[1] - side / 2 - grow, side + 2 * grow, side + 2 * grow);
    }
  }
}
