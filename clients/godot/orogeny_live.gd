@tool
class_name OrogenyLive
extends Node3D
## Follows a region of a terrain on the live channel of an Orogeny service.
##
## Pages are put together into one field of heights, which [signal heights_changed] hands out whenever it changed.
## With [member show_mesh] a child MeshInstance3D shows it, with [member make_collision] a child StaticBody3D collides.
## Metres are Godot's units: x goes to the east, y up, z to the south, and the node lies at the terrain's north-west
## corner.

## Some of the heights changed, or all of them came. [param heights] are metres, row by row from the north-west,
## [param size] samples along x and z, [param changed] the samples that changed.
signal heights_changed(heights: PackedFloat32Array, size: Vector2i, changed: Rect2i)
## An event of the service, as it came: `hello`, `operation`, `clients`, `done`, `error` and others.
signal event_received(event: Dictionary)
## The connection was lost, or refused. With [member reconnect] another one is tried.
signal connection_lost(why: String)

const PAGE_SIZE := 256
const HEADER_BYTES := 40
## Pages along one side of a terrain, at most.
const MAX_PAGES := 1 << 22
const MAX_MESSAGE_BYTES := 8 * 1024 * 1024
## Samples of a region, at most: more need a coarser level.
const MAX_SAMPLES := 4096 * 4096
## Samples along one side of a piece of the mesh.
const PIECE := 128
## What waits to be sent, at most: as much as the service takes as one message.
const MAX_SENT_BYTES := 1024 * 1024
const RECONNECT_AFTER_S := 2.0
## How long the service has to say why it refused a connection.
const REASON_AFTER_S := 5.0
const WINDOW := 16

@export var url := "http://127.0.0.1:4750"
## Which terrain: the file's name without its ending.
@export var terrain := ""
## What the history names whoever paints from here.
@export var author := "Godot"
## What the service asks for, where it does. It is kept in the scene: better set it by a script, or leave it empty and
## set the environment variable OROGENY_TOKEN.
@export var token := ""
## Where the region begins, metres from the terrain's north-west corner: x to the east, y to the south.
@export var region_begin := Vector2.ZERO
## How wide and deep it is, metres. 0: all of the terrain.
@export var region_size := Vector2.ZERO
## 0 is full resolution; each next level has one sample for two each way.
@export_range(0, 31) var level := 0
@export var show_mesh := true
@export var make_collision := false
@export var material: Material:
	set(value):
		material = value
		for piece: MeshInstance3D in _pieces.values():
			piece.material_override = value
@export var reconnect := true
## Whether it is connected, in the editor too.
@export var enabled := true:
	set(value):
		enabled = value
		if is_inside_tree():
			_close()
			if value:
				open()

## The heights, metres, row by row from the north-west; 0 where no page has come yet.
var heights := PackedFloat32Array()
## Samples along x and z.
var size := Vector2i.ZERO
## Metres between samples.
var spacing := 1.0
## Samples of the level west and north of the region.
var first := Vector2i.ZERO
## The latest revision that a page came with.
var revision := 0

var _socket: WebSocketPeer
var _was_open := false
var _wait_s := 0.0
var _reason: HTTPRequest
## Whether what is there stays until pages come: after a lost connection the ground must not fall away.
var _keeps := false
var _taken := 0
var _last_id := 0
var _subscription := 0
var _level_size := Vector2i.ZERO
var _changed := Rect2i()
## Pages that have come, by their places.
var _come: Dictionary = {}
var _pieces: Dictionary = {}
var _triangles_of: Dictionary = {}
var _shape: CollisionShape3D


# Not `_ready`, which comes once: a node may leave the tree and enter it again.
func _enter_tree() -> void:
	if enabled:
		open()


func _exit_tree() -> void:
	_close()


func _process(delta: float) -> void:
	if _socket == null:
		if enabled and reconnect and _wait_s > 0.0:
			_wait_s -= delta
			if _wait_s <= 0.0:
				_connect()
		return
	_socket.poll()
	var state := _socket.get_ready_state()
	if state == WebSocketPeer.STATE_OPEN:
		_was_open = true
		_receive()
		_tell_changes()
	elif state == WebSocketPeer.STATE_CLOSED and not _was_open:
		_ask_why()
	elif state == WebSocketPeer.STATE_CLOSED:
		var code := _socket.get_close_code()
		var why := "closed by the service (%d) %s" % [code, _socket.get_close_reason()]
		_lose(why.strip_edges() if code >= 0 else "the connection broke")


## Connects, and follows the region as it is set now.
func open() -> void:
	_keeps = false
	_connect()


func _connect() -> void:
	_close()
	if terrain.is_empty():
		return
	if not (url.begins_with("http://") or url.begins_with("https://")):
		_lose("the service's address is such as http://127.0.0.1:4750")
		return
	_socket = WebSocketPeer.new()
	_socket.inbound_buffer_size = MAX_MESSAGE_BYTES
	_socket.outbound_buffer_size = MAX_SENT_BYTES
	_socket.max_queued_packets = 4096
	if OS.has_feature("web"):
		if not _secret().is_empty():
			_socket.supported_protocols = PackedStringArray(["orogeny.v1", "bearer." + _secret()])
	else:
		_socket.handshake_headers = _authorization()
	# http becomes ws, and https wss.
	var error := _socket.connect_to_url("ws" + _address().trim_prefix("http"))
	if error != OK:
		_lose(error_string(error))


func _address() -> String:
	var path := "/v1/terrains/%s/live?author=%s" % [terrain.uri_encode(), author.uri_encode()]
	return url.trim_suffix("/") + path


func _secret() -> String:
	return token if not token.is_empty() else OS.get_environment("OROGENY_TOKEN")


func _authorization() -> PackedStringArray:
	var secret := _secret()
	return PackedStringArray() if secret.is_empty() else PackedStringArray(["Authorization: Bearer " + secret])


## A WebSocketPeer does not tell what it was refused with; the same address asked by plain HTTP does.
func _ask_why() -> void:
	_close()
	_reason = HTTPRequest.new()
	_reason.timeout = REASON_AFTER_S
	add_child(_reason, false, Node.INTERNAL_MODE_BACK)
	_reason.request_completed.connect(_take_reason)
	if _reason.request(_address(), _authorization()) != OK:
		_lose("there is no connection to %s" % url)


func _take_reason(result: int, status: int, _headers: PackedStringArray, body: PackedByteArray) -> void:
	if result != HTTPRequest.RESULT_SUCCESS:
		_lose("no service answers at %s" % url)
		return
	var answer: Variant = JSON.parse_string(body.get_string_from_utf8())
	var why := ""
	# 426: it would have taken a WebSocket now.
	if status != 426 and answer is Dictionary and answer.get("error") is Dictionary:
		why = str(answer["error"].get("message", ""))
	_lose(why if not why.is_empty() else "the service took no connection (%d)" % status)


## Draws a stroke. [param points] are places on the terrain, metres: x to the east, y to the south. Returns the number
## by which `done` or `error` will answer in [signal event_received]; 0 where it could not be sent.
func stroke(brush: Dictionary, points: PackedVector2Array, layer := "") -> int:
	var operation := {"op": "stroke", "brush": brush}
	if not layer.is_empty():
		operation["layer"] = layer
	var places := []
	for point in points:
		places.append([point.x, point.y])
	operation["points"] = places
	return _ask({"type": "apply", "operations": [operation]})


## Takes back what this author did last.
func undo() -> int:
	return _ask({"type": "undo"})


## Does again what this author took back last.
func redo() -> int:
	return _ask({"type": "redo"})


## The height at a place of this node's own space, metres, bilinear between samples.
func height_at(place: Vector3) -> float:
	if heights.is_empty():
		return 0.0
	var at := Vector2(place.x, place.z) / spacing - Vector2(first)
	at = at.clamp(Vector2.ZERO, Vector2(size - Vector2i.ONE))
	var low := Vector2i(at).min(size - Vector2i(2, 2)).max(Vector2i.ZERO)
	var high := (low + Vector2i.ONE).min(size - Vector2i.ONE)
	var along := at - Vector2(low)
	var north := lerpf(heights[low.y * size.x + low.x], heights[low.y * size.x + high.x], along.x)
	var south := lerpf(heights[high.y * size.x + low.x], heights[high.y * size.x + high.x], along.x)
	return lerpf(north, south, along.y)


func _ask(message: Dictionary) -> int:
	_last_id += 1
	message["id"] = _last_id
	return _last_id if _send(message) else 0


func _send(message: Dictionary) -> bool:
	if _socket == null or _socket.get_ready_state() != WebSocketPeer.STATE_OPEN:
		return false
	return _socket.send_text(JSON.stringify(message)) == OK


func _close() -> void:
	if _socket != null:
		_socket.close()
		_socket = null
	if _reason != null:
		_reason.queue_free()
		_reason = null
	_was_open = false
	_wait_s = 0.0
	_taken = 0


func _lose(why: String) -> void:
	_close()
	_keeps = true
	_wait_s = RECONNECT_AFTER_S
	connection_lost.emit(why)


func _receive() -> void:
	var frames := 0
	# Whoever hears an event may open another connection.
	var socket := _socket
	while _socket == socket and socket.get_available_packet_count() > 0:
		var packet := socket.get_packet()
		if socket.was_string_packet():
			_take_event(packet.get_string_from_utf8())
		elif _take_frame(packet):
			frames += 1
		else:
			_lose("a page frame that cannot be read")
			return
	if frames > 0 and _socket == socket:
		# The service holds pages back until it hears this, and then sends the latest state of each.
		_taken += frames
		_send({"type": "ack", "frames": _taken})


func _take_event(text: String) -> void:
	var event: Variant = JSON.parse_string(text)
	if not event is Dictionary or not event.has("event"):
		_lose("a message that is no event")
		return
	if event["event"] == "hello":
		_begin(event)
	elif event["event"] == "error" and event.get("id") == _subscription:
		_give_up(str(event.get("message", "the region is refused")))
	event_received.emit(event)


## Another try would end in the same way.
func _give_up(why: String) -> void:
	_close()
	size = Vector2i.ZERO
	heights.clear()
	_clear_children()
	connection_lost.emit(why)


func _begin(hello: Dictionary) -> void:
	if int(hello["page_size"]) != PAGE_SIZE:
		_give_up("pages have %d samples a side, this script knows %d" % [hello["page_size"], PAGE_SIZE])
		return
	var before := [spacing, first, size]
	spacing = float(hello["spacing"]) * pow(2.0, level)
	_level_size = Vector2i((int(hello["width"]) - 1 >> level) + 1, (int(hello["depth"]) - 1 >> level) + 1)
	var end := _level_size
	var region: Variant = null
	first = Vector2i.ZERO
	if region_size.x > 0.0 and region_size.y > 0.0:
		region = [region_begin.x, region_begin.y, region_size.x, region_size.y]
		first = _sample_at(region_begin).clamp(Vector2i.ZERO, _level_size)
		end = _sample_at(region_begin + region_size).clamp(Vector2i.ZERO, _level_size)
	size = end - first
	if size.x < 2 or size.y < 2 or size.x * size.y > MAX_SAMPLES:
		_give_up("the region lies outside, is too small, or needs a coarser level")
		return
	if not _keeps or before != [spacing, first, size]:
		heights.resize(size.x * size.y)
		heights.fill(0.0)
		_come.clear()
		_clear_children()
	_changed = Rect2i()
	revision = 0
	var message := {"type": "subscribe", "level": level, "format": "r32", "window": WINDOW}
	if region != null:
		message["region"] = region
	_subscription = _ask(message)


func _sample_at(place: Vector2) -> Vector2i:
	return Vector2i(_sample_along(place.x), _sample_along(place.y))


func _sample_along(place_m: float) -> int:
	# A place may miss a sample of full resolution by a millionth of a spacing and still be on it.
	var full := spacing / pow(2.0, level)
	var at_full := ceili(clampf(place_m / full, -1e9, 1e9) - 1e-6)
	return ceili(at_full / pow(2.0, level))


## Reads a page frame into the heights; whether it is one.
func _take_frame(frame: PackedByteArray) -> bool:
	if frame.size() < HEADER_BYTES or frame.slice(0, 4).get_string_from_ascii() != "OROG":
		return false
	if frame.decode_u16(4) != 1 or frame.decode_u16(6) != 0 or frame.decode_u8(9) != 0:
		return false
	var page_size := Vector2i(frame.decode_u16(10), frame.decode_u16(12))
	var place := Vector2i(frame.decode_u32(16), frame.decode_u32(20))
	var is_page := mini(page_size.x, page_size.y) >= 1 and maxi(page_size.x, page_size.y) <= PAGE_SIZE
	is_page = is_page and maxi(place.x, place.y) < MAX_PAGES and mini(place.x, place.y) >= 0
	var bytes := page_size.x * page_size.y * 4
	if not is_page or frame.decode_u32(32) != bytes or frame.size() != HEADER_BYTES + bytes:
		return false
	if frame.decode_u8(8) != level:
		# Of what was followed before.
		return true
	var page := Rect2i(place * PAGE_SIZE, page_size)
	var part := page.intersection(Rect2i(first, size))
	if not part.has_area():
		return true
	revision = maxi(revision, frame.decode_u64(24))
	var samples := frame.slice(HEADER_BYTES).to_float32_array()
	# A page comes whole, whatever little of it has changed: the mesh is made anew for that alone.
	var here := Rect2i(part.position - first, part.size) if not _come.has(place) else Rect2i()
	_come[place] = true
	for z in range(part.position.y, part.end.y):
		var from := (z - page.position.y) * page_size.x + part.position.x - page.position.x
		var to := (z - first.y) * size.x + part.position.x - first.x
		var row := samples.slice(from, from + part.size.x)
		if row == heights.slice(to, to + part.size.x):
			continue
		var west := part.size.x
		var east := 0
		for i in part.size.x:
			if heights[to + i] != row[i]:
				heights[to + i] = row[i]
				west = mini(west, i)
				east = i
		here = _merged(here, Rect2i(part.position.x - first.x + west, z - first.y, east - west + 1, 1))
	_changed = _merged(_changed, here)
	return true


func _merged(one: Rect2i, other: Rect2i) -> Rect2i:
	if not one.has_area():
		return other
	return one.merge(other) if other.has_area() else one


func _tell_changes() -> void:
	if not _changed.has_area():
		return
	var changed := _changed
	_changed = Rect2i()
	if show_mesh:
		_update_mesh(changed)
	if make_collision:
		_update_collision()
	heights_changed.emit(heights, size, changed)


func _clear_children() -> void:
	for piece: MeshInstance3D in _pieces.values():
		piece.queue_free()
	_pieces.clear()
	if _shape != null:
		_shape.get_parent().queue_free()
		_shape = null


## Makes those pieces of the mesh anew that hold a change. A sample more all around, for normals reach to the next one.
func _update_mesh(changed: Rect2i) -> void:
	var wide := changed.grow(1).intersection(Rect2i(Vector2i.ZERO, size))
	# A sample between two pieces belongs to both.
	@warning_ignore("integer_division")
	var from := (wide.position - Vector2i.ONE).max(Vector2i.ZERO) / PIECE
	@warning_ignore("integer_division")
	var to := (wide.end - Vector2i.ONE).min(size - Vector2i(2, 2)) / PIECE
	for row in range(from.y, to.y + 1):
		for column in range(from.x, to.x + 1):
			_update_piece(Vector2i(column, row))


func _update_piece(piece: Vector2i) -> void:
	var begin := piece * PIECE
	var side := (size - begin).min(Vector2i(PIECE + 1, PIECE + 1))
	var vertices := PackedVector3Array()
	var normals := PackedVector3Array()
	vertices.resize(side.x * side.y)
	normals.resize(side.x * side.y)
	# What is local is reached faster.
	var field := heights
	for z in side.y:
		var row := begin.y + z
		var north := maxi(row - 1, 0) * size.x
		var south := mini(row + 1, size.y - 1) * size.x
		for x in side.x:
			var column := begin.x + x
			var west := maxi(column - 1, 0)
			var east := mini(column + 1, size.x - 1)
			var i := z * side.x + x
			var middle := row * size.x
			vertices[i] = Vector3((first.x + column) * spacing, field[middle + column], (first.y + row) * spacing)
			var slope_x := (field[middle + east] - field[middle + west]) / (spacing * (east - west))
			var slope_z := (field[south + column] - field[north + column]) / (spacing * (south - north) / size.x)
			normals[i] = Vector3(-slope_x, 1.0, -slope_z).normalized()
	var arrays := []
	arrays.resize(Mesh.ARRAY_MAX)
	arrays[Mesh.ARRAY_VERTEX] = vertices
	arrays[Mesh.ARRAY_NORMAL] = normals
	# All pieces but those at the far edges have the same.
	if not _triangles_of.has(side):
		_triangles_of[side] = _triangles(side)
	arrays[Mesh.ARRAY_INDEX] = _triangles_of[side]
	var mesh := ArrayMesh.new()
	mesh.add_surface_from_arrays(Mesh.PRIMITIVE_TRIANGLES, arrays)
	if not _pieces.has(piece):
		var instance := MeshInstance3D.new()
		instance.material_override = material
		add_child(instance, false, Node.INTERNAL_MODE_BACK)
		_pieces[piece] = instance
	(_pieces[piece] as MeshInstance3D).mesh = mesh


## Two triangles a quad, clockwise from above, which is what Godot takes for the front.
func _triangles(side: Vector2i) -> PackedInt32Array:
	var indices := PackedInt32Array()
	indices.resize((side.x - 1) * (side.y - 1) * 6)
	var next := 0
	for z in side.y - 1:
		for x in side.x - 1:
			var north_west := z * side.x + x
			for corner: int in [0, 1, side.x, 1, side.x + 1, side.x]:
				indices[next] = north_west + corner
				next += 1
	return indices


## A height map's samples lie one unit apart about its middle, so the shape is scaled and moved.
func _update_collision() -> void:
	if _shape == null:
		var body := StaticBody3D.new()
		add_child(body, false, Node.INTERNAL_MODE_BACK)
		_shape = CollisionShape3D.new()
		body.add_child(_shape)
		_shape.shape = HeightMapShape3D.new()
	var map := _shape.shape as HeightMapShape3D
	map.map_width = size.x
	map.map_depth = size.y
	# Godot scales shapes alike along all axes only: heights are counted in spacings, too.
	var scaled := heights.duplicate()
	for i in scaled.size():
		scaled[i] /= spacing
	map.map_data = scaled
	_shape.scale = Vector3.ONE * spacing
	var middle := (Vector2(first) + Vector2(size - Vector2i.ONE) / 2.0) * spacing
	_shape.position = Vector3(middle.x, 0.0, middle.y)
