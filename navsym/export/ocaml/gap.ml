(* The kinds `gap`, `sliver`, `touch` and `range` of docs/certificates.md: an optimum between a dual and a support, and contacts along pieces. *)

open Text
open Tree
open Ball
open Value
open Goal

type panel = { first : tree; last : tree; sigma : tree; regressors : tree list }

type problem = {
  panels : panel list;
  functional : tree list;
  place : string; (* the variable of the regressors *)
  parameter : side; (* of the problem *)
  named : string;
  first_end : Q.t;
  last_end : Q.t;
  lower : Q.t;
  upper : Q.t;
  mutable left : int; (* cells that all bisections share *)
}

let share = "share of a panel" (* no name of a certificate has blanks *)

(* x**0 is 1 here, wherever x has a value. *)
let with_unit_powers =
  replace (function Pow (a, b) when !constant b = Some Q.zero -> Some (Sum [ one; Prod [ zero; a ] ]) | _ -> None)

let read_within what names value =
  let t = with_unit_powers (get_tree what value) in
  Names.iter (fun s -> if not (List.mem s names) then no_symbols s) (symbols t);
  t

let problem_keys = [ "kind"; "variable"; "parameter"; "panels"; "functional"; "from"; "to"; "lower"; "upper"; "bits"; "cells" ]

(* The problem, and the values of the other keys *)
let read_problem keys value ~use =
  let values = get_keys "gap" (problem_keys @ keys) value in
  match values with
  | _ :: variable :: parameter :: panels :: functional :: first :: last :: lower :: upper :: bits :: cells :: others ->
      let bits = get_bits 20000 bits in
      let cells = get_integer "cells" 0 (most_cells bits) cells in
      at_precision bits (fun () ->
          let t = get_name "variable" variable and p = get_name "parameter" parameter in
          if t = p then refuse "variable, parameter: expected two names";
          let functional = List.map (read_within "functional" [ p ]) (get_list "functional" functional) in
          let read_panel v =
            match get_keys "panel" [ "measurement"; "from"; "to"; "sigma"; "H" ] v with
            | [ _; first; last; sigma; h ] ->
                let of_p what = read_within what [ p ] in
                let regressors = List.map (read_within "H" [ t; p ]) (get_list "H" h) in
                same_length "H" functional regressors;
                { first = of_p "from" first; last = of_p "to" last; sigma = of_p "sigma" sigma; regressors }
            | _ -> assert false
          in
          let panels = List.map read_panel (get_list "panels" panels) in
          if panels = [] || functional = [] then refuse "panels, functional: expected entries";
          let first = get_number "from" first and last = get_number "to" last in
          let lower = get_number "lower" lower and upper = get_number "upper" upper in
          let low = of_rational first in
          let parameter = { low; length = less (of_rational last) low; start = Z.zero; level = 0 } in
          use { panels; functional; place = t; parameter; named = p; first_end = first; last_end = last; lower; upper; left = cells_allowed cells } others)
  | _ -> assert false

(* A tree of the place and the parameter on a panel, as one of the share and the parameter *)
let on_panel problem panel =
  let place = Sum [ panel.first; Prod [ subtract panel.last panel.first; Sym share ] ] in
  replace (function Sym s when s = problem.place -> Some place | _ -> None)

let cell_of problem side = Map_of_names.(add problem.named problem.parameter (singleton share side))
let whole_side = { low = ball_zero; length = ball_one; start = Z.zero; level = 0 }

(* The ball of a tree on a cell, by itself and as mean value form *)
let ball_on cell t =
  let value balls s = match Map_of_names.find_opt s balls with Some x -> x | None -> no_symbols s in
  let balls = Map_of_names.map part_ball cell in
  match ball Whole (value balls) t with x when is_finite x -> Some (x, fun () -> mean_value_ball balls cell t) | _ -> None
  | exception No_value -> None

let is_below_one x = is_above (less ball_one x) && is_above (plus ball_one x)

(* |f| < 1 on the panel; f has a value there. *)
let check_below_one problem t =
  let settled cell =
    match ball_on cell t with
    | None -> false
    | Some (x, mean) -> is_below_one x || (match mean () with y -> is_below_one y | exception No_value -> false)
  in
  let counted cell =
    problem.left <- problem.left - 1;
    settled cell
  in
  bisect ~cells:problem.left ~names:[ share ] ~settled:counted (cell_of problem whole_side)

let ball_at problem x t =
  match ball_on (cell_of problem { whole_side with low = x; length = ball_zero }) t with
  | Some (y, _) -> y
  | None -> refuse "no value on the panel"

(* W with M W = P, by elimination with the pivot that is farthest from 0 *)
let rec solve rows =
  match rows with
  | [] -> []
  | _ ->
      let distance (row, _) = (size (List.hd row)).lo in
      let best = List.fold_left (fun m row -> greatest m (distance row)) nought rows in
      let rec pick before = function
        | row :: l when compare_ends (distance row) best = 0 -> (row, List.rev_append before l)
        | row :: l -> pick (row :: before) l
        | [] -> assert false
      in
      let (pivot, right), others = pick [] rows in
      let reduce (row, b) =
        let c = over (List.hd row) (List.hd pivot) in
        (List.map2 (fun x p -> less x (times c p)) (List.tl row) (List.tl pivot), less b (times c right))
      in
      let rest = solve (List.map reduce others) in
      let known = List.fold_left2 (fun s p x -> plus s (times p x)) ball_zero (List.tl pivot) rest in
      over (less right known) (List.hd pivot) :: rest

let check_panels problem =
  let is_positive t = match ball_at problem ball_zero t with x -> is_above x in
  let check p = shown "a panel without length, or a noise bound that is not > 0" (is_positive (subtract p.last p.first) && is_positive p.sigma) in
  List.iter check problem.panels

let over_sigma panel t = Prod [ t; Pow (panel.sigma, Num Q.minus_one) ]
let total = List.fold_left plus ball_zero

let check value =
  read_problem [ "dual"; "support" ] value ~use:(fun problem others ->
      match others with
      | [ dual; support ] ->
          let dual = List.map (get_number "dual") (get_list "dual" dual) in
          same_length "dual" problem.functional dual;
          check_panels problem;
          let read_place v =
            match get_list "support" v with
            | [ i; v ] ->
                let v = get_number "support" v in
                if Q.sign v < 0 || Q.gt v Q.one then refuse "support: expected a share from 0 to 1";
                (List.nth problem.panels (get_integer "support" 0 (List.length problem.panels - 1) i), of_rational v)
            | _ -> refuse "support: expected [panel, share]"
          in
          let support = List.map read_place (get_list "support" support) in
          same_length "support" problem.functional support;
          let check_panel p =
            let f = Sum (zero :: List.map2 (fun x h -> Prod [ Num x; h ]) dual p.regressors) in
            check_below_one problem (on_panel problem p (over_sigma p f))
          in
          List.iter check_panel problem.panels;
          let functional = List.map (ball_at problem ball_zero) problem.functional in
          let value = total (List.map2 (fun x p -> times (of_rational x) p) dual functional) in
          let is_least a b = sign_of (less b a).lo >= 0 in
          shown "the optimum is not between the bounds" (is_least (of_rational problem.lower) value);
          let column (p, v) = List.map (fun h -> ball_at problem v (on_panel problem p (over_sigma p h))) p.regressors in
          let columns = List.map column support in
          let rows = List.mapi (fun i p -> (List.map (fun c -> List.nth c i) columns, p)) functional in
          let weights = match solve rows with w -> w | exception No_value -> refuse "a linear system that may be singular" in
          shown "the optimum is not between the bounds" (is_least (total (List.map size weights)) (of_rational problem.upper))
      | _ -> assert false)

(* Pieces: everything is a function of a share from -1 to 1 of the piece, in cells; only balls count that hold all of a cell. *)

let along = "share of a piece"

type contact = { own : panel; at : tree; weight : tree; outward : int; sign : Q.t }
type piece = { middle : Q.t; half : Q.t; basis : Q.t list list; dual : tree list; contacts : contact list; radii : Q.t list }

let get_numbers what value = List.map (get_number what) (get_list what value)

let read_polynomial what value =
  match get_numbers what value with
  | [] -> refuse "%s: expected coefficients" what
  | first :: _ as l -> (first, List.fold_right (fun q t -> Sum [ Num q; Prod [ Sym along; t ] ]) l zero)

let read_contact problem value =
  match get_keys "contact" [ "panel"; "at"; "weight" ] value with
  | [ i; at; weight ] ->
      let own = List.nth problem.panels (get_integer "panel" 0 (List.length problem.panels - 1) i) in
      let first, w = read_polynomial "weight" weight in
      let outward = match at with List [ Text "0" ] -> -1 | List [ Text "1" ] -> 1 | _ -> 0 in
      { own; at = snd (read_polynomial "at" at); weight = w; outward; sign = (if Q.sign first > 0 then Q.one else Q.minus_one) }
  | _ -> assert false

(* The end of the piece, which begins where the one before ends *)
let read_piece problem start value =
  match get_keys "piece" [ "from"; "to"; "basis"; "dual"; "contacts"; "radius" ] value with
  | [ first; last; basis; dual; contacts; radii ] ->
      let first = get_number "from" first and last = get_number "to" last in
      if not (Q.equal first start) || Q.gt first last then refuse "the pieces leave a hole";
      let basis = List.map (get_numbers "basis") (get_list "basis" basis) in
      same_length "basis" problem.functional basis;
      List.iter (same_length "basis" problem.functional) basis;
      let dual = List.map (fun v -> snd (read_polynomial "dual" v)) (get_list "dual" dual) in
      same_length "dual" problem.functional dual;
      let contacts = List.map (read_contact problem) (get_list "contacts" contacts) in
      let radii = get_numbers "radius" radii in
      let unknowns = List.length dual + (2 * List.length contacts) in
      if contacts = [] || List.length radii <> unknowns then refuse "expected a contact, and a radius of each unknown";
      let two = Q.of_int 2 in
      ({ middle = Q.div (Q.add first last) two; half = Q.div (Q.sub last first) two; basis; dual; contacts; radii }, last)
  | _ -> assert false

let in_order n f =
  let before = !Observability.order in
  Observability.order := n;
  Fun.protect ~finally:(fun () -> Observability.order := before) f

let series_at s x value =
  let moving = List.map (function 0 -> x | 1 -> ball_one | _ -> ball_zero) (Observability.indices ()) in
  Observability.series (fun name -> if name = s then moving else Observability.constant_series (value name))

let evaluate l u = List.fold_right (fun c y -> plus c (times u y)) l ball_zero
let derivative l = match l with [] -> [] | _ :: l -> List.mapi (fun k c -> times (of_int (k + 1)) c) l

let centre_of x =
  match (x.lo, x.hi) with
  | At (m, e), At (n, f) -> round_ball (scale (plus (exactly m e) (exactly n f)) (-1))
  | _ -> raise No_value

let widened x = let width = less x (centre_of x) in plus x (double width)

(* The polynomial of Taylor's formula about a centre, with the remainder for a ball around it as its last coefficient *)
let expand_about n s centre whole value t =
  in_order n (fun () ->
      let thin = series_at s centre value t and wide = series_at s (hull whole centre) value t in
      List.mapi (fun k c -> if k = n - 1 then List.nth wide k else c) thin)

let enclose_along cell t =
  let centre = centre_of cell in
  evaluate (expand_about 9 along centre cell no_symbols t) (less cell centre)

let check_piece problem piece =
  let parameter = Sum [ Num piece.middle; Prod [ Num piece.half; Sym along ] ] in
  let put_parameter = put [ (problem.named, parameter) ] in
  let in_basis l = List.map (fun row -> Sum (zero :: List.map2 (fun b t -> Prod [ Num b; t ]) row l)) piece.basis in
  let target = in_basis (List.map put_parameter problem.functional) in
  let rows = List.map (fun p -> (p, in_basis (List.map (fun h -> put_parameter (on_panel problem p (over_sigma p h))) p.regressors))) problem.panels in
  let rows_of p = List.assq p rows in
  let dot l = Sum (zero :: List.map2 (fun a b -> Prod [ a; b ]) piece.dual l) in
  let here c = put [ (share, c.at) ] in
  let weighted i = Sum (zero :: List.map (fun c -> Prod [ c.weight; here c (List.nth (rows_of c.own) i) ]) piece.contacts) in
  let rate c = if c.outward <> 0 then zero else here c (Calculus.derive share (dot (rows_of c.own))) in
  let missed =
    List.mapi (fun i p -> subtract p (weighted i)) target
    @ List.map (fun c -> negate (rate c)) piece.contacts
    @ List.map (fun c -> subtract (Num c.sign) (here c (dot (rows_of c.own)))) piece.contacts
  in
  let curves = piece.dual @ List.map (fun c -> c.at) piece.contacts @ List.map (fun c -> c.weight) piece.contacts in
  let m = List.length target and l = List.length piece.contacts in
  let split z = (List.filteri (fun i _ -> i < m) z, List.filteri (fun i _ -> i >= m && i < m + l) z, List.filteri (fun i _ -> i >= m + l) z) in
  let sum_up a b = total (List.map2 times a b) in
  let column k n x = List.init n (fun i -> if i = k then x else ball_zero) in
  let settled cell =
    let cell = part_ball (find cell along) in
    let value s = if s = along then cell else no_symbols s in
    let on t = ball Whole value t in
    let known = List.map (enclose_along cell) curves in
    let near = List.map2 (fun c r -> plus c (times unit_ball (of_rational r))) known piece.radii in
    let x, places, weights = split near in
    (* all derivatives: rows of the sums, of the places, of the signs *)
    let expand c v = in_order 3 (fun () -> List.map (series_at share v value) (rows_of c.own)) in
    let q = List.map2 expand piece.contacts places in
    let order k = List.map (fun h -> List.nth h k) in
    let sums i = List.init m (fun _ -> ball_zero)
      @ List.map2 (fun q w -> times w (List.nth (List.nth q i) 1)) q weights @ List.map (fun q -> List.hd (List.nth q i)) q in
    let place k c = let q = List.nth q k in
      if c.outward <> 0 then List.init m (fun _ -> ball_zero) @ column k l ball_one @ column l l ball_one
      else order 1 q @ column k l (double (sum_up x (order 2 q))) @ column l l ball_one in
    let sign k _ = let q = List.nth q k in order 0 q @ column k l (sum_up x (order 1 q)) @ column l l ball_one in
    let matrix = List.init m sums @ List.mapi place piece.contacts @ List.mapi sign piece.contacts in
    let move = solve (List.combine matrix (List.map (enclose_along cell) missed)) in
    shown "Newton's test fails" (List.for_all2 (fun d r -> is_above (less (of_rational r) (size d))) move piece.radii);
    let x, places, weights = split (List.map2 plus known move) in
    let fits c v w = is_above (times (of_rational c.sign) w) && (c.outward <> 0 || (is_above v && is_above (less ball_one v))) in
    shown "a weight of the wrong sign, or a contact outside its panel" (List.for_all2 (fun (c, v) w -> fits c v w) (List.combine piece.contacts places) weights);
    let optimum = plus (enclose_along cell (dot target)) (sum_up (let d, _, _ = split move in d) (List.map on target)) in
    let is_least a b = sign_of (less b a).lo >= 0 in
    shown "the optimum is not between the bounds" (is_least (of_rational problem.lower) optimum && is_least optimum (of_rational problem.upper));
    let touching = List.combine piece.contacts places in
    let check_panel (p, q) =
      let is_positive t = is_above (on (put_parameter t)) in
      shown "a panel without length, or a noise bound that is not > 0" (is_positive (subtract p.last p.first) && is_positive p.sigma);
      let within cell =
        let side = find cell share in
        let v = part_ball side and length = scale ball_one (-side.level) in
        (* within its own width of where a contact may be *)
        let is_near (c, place) = c.own == p && not (is_above (less (size (less (widened place) (middle_ball side))) length)) in
        let touch = List.find_opt is_near touching in
        let place = match touch with Some (_, place) -> place | None -> v in
        let whole = hull v place and centre = centre_of place in
        let terms = List.map (expand_about 16 share centre whole value) q in
        let f = List.init 16 (fun k -> sum_up x (List.map (fun h -> List.nth h k) terms)) and u = less whole centre in
        match touch with
        | None -> is_below_one (evaluate f u)
        | Some (c, place) ->
            let signed = times (of_rational c.sign) and slopes = derivative f in
            let rises u = times (of_int c.outward) (signed (evaluate slopes u)) in
            let concave = sign_of (rises (less place centre)).lo >= 0 && is_below (signed (evaluate (derivative slopes) u)) in
            (concave || is_above (rises u)) && is_above (plus ball_one (signed (evaluate f u)))
      in
      let cells = if Q.sign piece.half > 0 then min problem.left 400 else problem.left in (* shorter pieces are tried after those *)
      bisect ~cells ~names:[ share ] ~settled:(fun cell -> try within cell with No_value -> false)
        (Map_of_names.singleton share whole_side)
    in
    List.iter check_panel rows
  in
  let ends = if Q.sign piece.half > 0 then 1 else 0 in (* a piece that is a point has s = 0 *)
  let whole = { low = of_int (-ends); length = of_int (2 * ends); start = Z.zero; level = 0 } in
  (* a cell fails for one reason at a time: where no half of it can do better, the reason is that of the whole *)
  let attempt cell = try settled cell; true with Refused _ | No_value when Q.sign piece.half > 0 -> false in
  bisect ~cells:40 ~names:[ along ] ~settled:attempt (Map_of_names.singleton along whole)

let check_pieces value =
  read_problem [ "pieces" ] value ~use:(fun problem others ->
      let pieces = match others with [ pieces ] -> get_list "pieces" pieces | _ -> assert false in
      let follow start v =
        let piece, last = read_piece problem start v in
        check_piece problem piece;
        last
      in
      let first = problem.first_end in
      let last = List.fold_left follow first pieces in
      if pieces = [] || not (Q.equal last problem.last_end) then refuse "the pieces do not reach the end")
